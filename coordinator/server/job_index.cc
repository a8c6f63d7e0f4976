#include "coordinator/server/job_index.h"

#include <algorithm>

namespace cairn::coordinator {

JobIndex::Filed JobIndex::AsItStands(const Job& job) {
  Filed filed{job.order, job.hash,      job.owner,   {},
              false,     job.Running(), job.Ended(), job.state == proto::JOB_PAUSED};
  // One that is done would give the same bits again.
  filed.serves = !job.leaving && (!job.Ended() || job.state == proto::JOB_DONE);
  if (job.Final()) return filed;
  for (const auto& [name, binary] : job.spec.input_blobs())
    if (const Result<Hash> input = Hash::FromBinary(binary); input.ok())
      filed.inputs.push_back(input.value());
  std::sort(filed.inputs.begin(), filed.inputs.end());
  filed.inputs.erase(std::unique(filed.inputs.begin(), filed.inputs.end()), filed.inputs.end());
  return filed;
}

void JobIndex::File(const std::string& id, const Job* job) {
  auto before = filed_.find(id);
  if (job == nullptr) {
    if (before == filed_.end()) return;
    Remove(before->second);
    filed_.erase(before);
    return;
  }
  Filed now = AsItStands(*job);
  if (before == filed_.end())
    before = filed_.try_emplace(id).first;
  else if (before->second == now)
    return;
  else
    Remove(before->second);
  before->second = std::move(now);
  Add(before->first, before->second);
}

void JobIndex::Add(const std::string& id, const Filed& filed) {
  running_ += filed.running;
  if (filed.serves) serving_[filed.hash][filed.order] = &id;
  OwnedJobs& owned = owned_[filed.owner];
  owned.not_ended += !filed.ended;
  for (const Hash& hash : filed.inputs) {
    OwnedJobs::Input& input = owned.inputs[hash];
    if (++input.jobs == 1) owned.input_bytes += input.bytes = bytes_of_(hash);
  }
}

void JobIndex::Remove(const Filed& filed) {
  running_ -= filed.running;
  if (filed.serves) {
    const auto same = serving_.find(filed.hash);
    same->second.erase(filed.order);
    if (same->second.empty()) serving_.erase(same);
  }
  OwnedJobs& owned = owned_.at(filed.owner);
  owned.not_ended -= !filed.ended;
  for (const Hash& hash : filed.inputs) {
    const auto input = owned.inputs.find(hash);
    if (--input->second.jobs > 0) continue;
    owned.input_bytes -= input->second.bytes;
    owned.inputs.erase(input);
  }
}

const std::string* JobIndex::Serving(const Hash& hash,
                                     const std::function<bool(const std::string& owner)>& may_command) const {
  const auto same = serving_.find(hash);
  if (same == serving_.end()) return nullptr;
  const std::string* anothers = nullptr;
  for (const auto& [order, id] : same->second) {
    const Filed& filed = filed_.at(*id);
    if (may_command(filed.owner)) return id;
    if (anothers == nullptr && !filed.paused) anothers = id;
  }
  return anothers;
}

const OwnedJobs& JobIndex::Of(const std::string& owner) const {
  static const OwnedJobs kNone;
  const auto owned = owned_.find(owner);
  return owned == owned_.end() ? kNone : owned->second;
}

}  // namespace cairn::coordinator
