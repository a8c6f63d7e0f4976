#include "coordinator/core/blob_ledger.h"

#include <algorithm>
#include <utility>

namespace cairn::coordinator {

void BlobLedger::Add(Hold& hold, const Hash& hash) {
  if (hold.insert(hash).second) ++counts_[hash];
}

void BlobLedger::Replace(Hold& hold, HashSet hashes) {
  for (const Hash& hash : hashes) ++counts_[hash];
  for (const Hash& hash : hold) Decrease(hash);
  hold = std::move(hashes);
}

void BlobLedger::Move(Hold& from, Hold& to) {
  Release(to);
  to = std::exchange(from, {});
}

void BlobLedger::Decrease(const Hash& hash) {
  const auto it = counts_.find(hash);
  CAIRN_DEMAND(it != counts_.end(), "released more often than held");
  if (--it->second > 0) return;
  counts_.erase(it);
  candidates_.push_back(hash);
}

std::vector<Hash> BlobLedger::TakeDropped() {
  std::vector<Hash> dropped;
  for (const Hash& hash : candidates_)
    if (!Held(hash)) dropped.push_back(hash);
  candidates_.clear();
  std::sort(dropped.begin(), dropped.end());
  dropped.erase(std::unique(dropped.begin(), dropped.end()), dropped.end());
  return dropped;
}

}  // namespace cairn::coordinator
