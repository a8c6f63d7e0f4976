// Checkpoints: at most one of a job under way, made of the job as it stands; rounds never wait for them. A
// round is saved with the partials that it has, unless it is so young that they are cheaper made than
// written.
#include <algorithm>
#include <utility>

#include "coordinator/core/core.h"

namespace cairn::coordinator {
namespace {

constexpr double kYoung = 1;  // intervals
// The event loop takes one to two microseconds to make a checkpoint of each partial: that is to be a few
// hundredths of its time, however many a round has.
constexpr double kPartial_s = 30e-6;

}  // namespace

void Core::WantSave(Job& job, bool at_once) {
  job.saving.due = true;
  job.saving.at_once |= at_once;
  if (at_once) job.saving.not_before_s = 0;
}

// An event touches few jobs; the intervals of all are looked at with every tick.
void Core::SaveWhatIsDue() {
  if (all_touched_) {
    for (auto& [order, job] : jobs_) SaveIfDue(job);
    return;
  }
  for (const std::uint64_t order : touched_)
    if (const auto it = jobs_.find(order); it != jobs_.end()) SaveIfDue(it->second);
}

void Core::SaveIfDue(Job& job) {
  const Saving& saving = job.saving;
  if (!saving.due || saving.under_way || job.leaving || job.SavingWaits()) return;
  if (now_s_ < saving.not_before_s && !saving.at_once) return;
  const double many_s = kPartial_s * static_cast<double>(job.holds.partials.size());
  const bool long_ago = options_.checkpoint_rounds > 0
                            ? saving.rounds >= options_.checkpoint_rounds
                            : now_s_ - saving.last_s >= std::max(options_.checkpoint_interval_s, many_s);
  if (saving.at_once || long_ago) Save(job);
}

void Core::Save(Job& job) {
  Saving& saving = job.saving;
  saving.due = saving.at_once = false;
  saving.under_way = true;
  saving.last_s = now_s_;
  saving.rounds = 0;
  saving.with_partials |= now_s_ - job.round_since_s >= kYoung * options_.checkpoint_interval_s;
  Persist persist{MakeCheckpoint(job, now_s_, saving.with_partials), saving.unpublished};
  persist.checkpoint.set_number(++saving.number);
  if (persist.checkpoint.state() != proto::JOB_RUNNING && persist.checkpoint.state() != proto::JOB_PAUSED)
    persist.checkpoint.set_ended_served_s(job.Ended() ? job.ended_served_s : served_s());
  saving.publishing = persist.publish.size();
  saving.saves = persist.checkpoint.state();
  HashSet needed;
  needed.reserve(static_cast<std::size_t>(persist.checkpoint.blobs_size()) + persist.publish.size());
  for (const std::string& blob : persist.checkpoint.blobs()) needed.insert(Hash::FromBinary(blob).value());
  for (const Publish& publish : persist.publish) needed.insert(publish.result);
  ledger_.Replace(job.holds.saving, std::move(needed));
  actions_.push_back(std::move(persist));
}

void Core::On(const PersistDone& event) {
  Job* job = FindById(event.job);
  if (job == nullptr || !job->saving.under_way || job->saving.number != event.number) return;
  Saving& saving = job->saving;
  saving.under_way = false;
  saving.durable = true;
  ++tally_.checkpoints;
  for (std::size_t i = 0; i < saving.publishing; ++i)
    Say(Report::kInfo, *job,
        "the result of stage '" + job->spec.stages(static_cast<int>(saving.unpublished[i].stage)).name() +
            "' is published");
  saving.unpublished.erase(saving.unpublished.begin(),
                           saving.unpublished.begin() + static_cast<std::ptrdiff_t>(saving.publishing));
  saving.publishing = 0;
  ledger_.Move(job->holds.saved, job->holds.saved_before);
  ledger_.Move(job->holds.saving, job->holds.saved);
  if (saving.saves == proto::JOB_DONE && job->Running()) {
    SetState(*job, proto::JOB_DONE, "");
    Say(Report::kInfo, *job, "done");
  }
  if (job->Final() && job->state == saving.saves) ReleaseAll(*job);
  AnswerDurable(*job, event.number);
}

void Core::On(const PersistFailed& event) {
  Job* job = FindById(event.job);
  if (job == nullptr || !job->saving.under_way || job->saving.number != event.number) return;
  job->saving.under_way = false;
  job->saving.publishing = 0;
  ++tally_.checkpoint_failures;
  ledger_.Release(job->holds.saving);
  const std::string why = "cannot save: " + event.reason;
  Say(Report::kWarning, *job, why);
  if (!job->saving.durable && !job->pending.empty()) return RefuseSubmission(*job, why);
  RefusePending(*job, why);
  if (!job->Ended() && !job->held) SetState(*job, proto::JOB_PAUSED, why);
  WantSave(*job, job->SavingWaits());
  // Nobody resumes what has ended, yet a restart must not find it running: it is tried again by and by.
  if (!job->SavingWaits()) job->saving.not_before_s = now_s_ + options_.save_again_s;
}

void Core::On(const SaveNow&) {
  all_touched_ = true;
  for (auto& [order, job] : jobs_) {
    if (!job.saving.due) continue;
    job.saving.at_once = true;
    job.saving.not_before_s = 0;
  }
}

}  // namespace cairn::coordinator
