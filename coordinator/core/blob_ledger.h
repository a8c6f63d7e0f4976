// Who still needs which blob. A blob that nobody holds any more is handed out once, to be dropped.
#pragma once

#include <cstring>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "schema/hash.h"

namespace cairn::coordinator {

// A round has a hundred thousand of them: no trees. A content hash is one already.
struct HashOfHash {
  std::size_t operator()(const Hash& hash) const {
    std::size_t first = 0;
    std::memcpy(&first, hash.bytes.data(), sizeof first);
    return first;
  }
};
using HashSet = std::unordered_set<Hash, HashOfHash>;
template <class T>
using HashMap = std::unordered_map<Hash, T, HashOfHash>;

class BlobLedger {
 public:
  // A set of blobs that one holder needs. It must be released before it is destroyed.
  using Hold = HashSet;

  void Add(Hold& hold, const Hash& hash);
  // Takes the new blobs before it lets the old ones go, so that what is in both is never dropped.
  void Replace(Hold& hold, HashSet hashes);
  void Release(Hold& hold) { Replace(hold, {}); }
  // `to` holds what `from` did, which holds nothing then.
  void Move(Hold& from, Hold& to);
  // A blob that came in but that perhaps nobody wants: dropped at the next TakeDropped() if nobody holds it
  // then.
  void Offer(const Hash& hash) { candidates_.push_back(hash); }
  bool Held(const Hash& hash) const { return counts_.contains(hash); }
  std::size_t size() const { return counts_.size(); }
  // The blobs that lost their last holder (or never had one) since the last call, and have none now.
  std::vector<Hash> TakeDropped();

 private:
  void Decrease(const Hash& hash);

  HashMap<int> counts_;
  std::vector<Hash> candidates_;
};

}  // namespace cairn::coordinator
