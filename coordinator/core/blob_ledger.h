// Who still needs which blob. A blob that nobody holds any more is handed out once, to be dropped.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "schema/hash.h"

namespace cairn::coordinator {

using HashSet = std::set<Hash>;

class BlobLedger {
 public:
  // A set of blobs that one holder needs. It must be released before it is destroyed.
  using Hold = HashSet;

  void Add(Hold& hold, const Hash& hash);
  // Takes the new blobs before it lets the old ones go, so that what is in both is never dropped.
  void Replace(Hold& hold, const HashSet& hashes);
  void Release(Hold& hold) { Replace(hold, {}); }
  // A blob that came in but that perhaps nobody wants: dropped at the next TakeDropped() if nobody holds it
  // then.
  void Offer(const Hash& hash) { candidates_.insert(hash); }
  bool Held(const Hash& hash) const { return counts_.contains(hash); }
  std::size_t size() const { return counts_.size(); }
  // The blobs that lost their last holder (or never had one) since the last call, and have none now.
  std::vector<Hash> TakeDropped();

 private:
  void Decrease(const Hash& hash);

  std::map<Hash, int> counts_;
  HashSet candidates_;
};

}  // namespace cairn::coordinator
