#include "coordinator/core/blob_ledger.h"

namespace cairn::coordinator {

void BlobLedger::Add(Hold& hold, const Hash& hash) {
  if (hold.insert(hash).second) ++counts_[hash];
}

void BlobLedger::Replace(Hold& hold, const HashSet& hashes) {
  for (const Hash& hash : hashes) ++counts_[hash];
  for (const Hash& hash : hold) Decrease(hash);
  hold = hashes;
}

void BlobLedger::Decrease(const Hash& hash) {
  const auto it = counts_.find(hash);
  CAIRN_DEMAND(it != counts_.end(), "released more often than held");
  if (--it->second > 0) return;
  counts_.erase(it);
  candidates_.insert(hash);
}

std::vector<Hash> BlobLedger::TakeDropped() {
  std::vector<Hash> dropped;
  for (const Hash& hash : candidates_)
    if (!Held(hash)) dropped.push_back(hash);
  candidates_.clear();
  return dropped;
}

}  // namespace cairn::coordinator
