// Jobs come, end, and come back.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/core.h"

namespace cairn::coordinator {
namespace {

std::string Days(double seconds) { return fmt::format("{:.3g} days", seconds / 86400); }

}  // namespace

Job* Core::FindById(const std::string& id) {
  const auto it = orders_.find(id);
  if (it == orders_.end()) return nullptr;
  touched_.insert(it->second);
  return &jobs_.at(it->second);
}

void Core::On(const SubmitJob& event) {
  for (const Hash& blob : event.blobs) ledger_.Offer(blob);
  if (Job* known = FindById(event.id); known != nullptr) {  // told twice
    if (known->leaving) return Tell(event.asker, event.id, "it is being deleted");
    return AnswerAsItStands(*known, event.asker, true);
  }
  const std::uint64_t order = next_order_++;
  orders_[event.id] = order;
  touched_.insert(order);
  Job& job = jobs_[order];
  job.id = event.id;
  job.order = order;
  job.owner = event.owner;
  job.SetSpec(event.job);
  job.running_since_s = job.round_since_s = now_s_;
  actions_.push_back(JobChanged{job.id});
  Say(Report::kInfo, job,
      "submitted: " + std::to_string(job.StageCount()) + (job.StageCount() == 1 ? " stage" : " stages") +
          (job.spec.priority() == 0 ? "" : ", priority " + std::to_string(job.spec.priority())));
  AnswerWhenSaved(job, event.asker, job.Stands());
  const std::string wrong = CheckJob(job.spec);
  if (!wrong.empty()) return FailJob(job, wrong, true);
  for (const auto& [name, hash] : job.spec.input_blobs())
    ledger_.Add(job.holds.inputs, Hash::FromBinary(hash).value());
  BeginAgain(job);
  WantSave(job, true);
}

// Puts the task that the job stands at back to its beginning: START, or the tasks of its step.
void Core::BeginAgain(Job& job) {
  job.round_since_s = now_s_;
  job.task_seconds.clear();
  if (job.AllStagesDone()) {
    job.tasks = Round();
    return;
  }
  while (job.facts.size() <= job.stage) job.facts.emplace_back();
  job.facts.back().set_open_compute_seconds(0);
  if (!job.step) {
    job.tasks = Round::OfPlan(wire::TaskKey::START);
    return;
  }
  job.partials.assign(static_cast<std::size_t>(job.step->tasks_size()), Hash{});
  ledger_.Release(job.holds.partials);
  job.tasks = job.partials.empty() ? Round::OfPlan(wire::TaskKey::ADVANCE) : Round::OfTasks(*job.step);
  job.eta.BeginRound(*job.step, job.tasks, now_s_);
}

void Core::SetState(Job& job, proto::JobState state, const std::string& reason) {
  job.seconds_before = job.Seconds(now_s_);
  job.running_since_s = now_s_;
  job.state = state;
  job.reason = reason;
  job.ended_served_s = job.Ended() ? served_s() : 0;
  job.input_error = job.held = false;
  job.eta.GoOn();
  actions_.push_back(JobChanged{job.id});
}

void Core::FailJob(Job& job, const std::string& whole_reason, bool input_error) {
  if (job.Ended()) return;
  const std::string reason = CutReason(whole_reason);
  WithdrawAll(job);
  ledger_.Release(job.holds.partials);
  SetState(job, proto::JOB_FAILED, reason);
  job.input_error = input_error;
  WantSave(job, true);
  Say(Report::kWarning, job, "failed: " + reason);
}

void Core::On(const Served& event) { served_from_s_ = now_s_ - event.seconds; }

void Core::On(const RestoreJob& event) {
  const proto::Checkpoint& saved = event.checkpoint;
  if (orders_.contains(saved.job_id())) return;
  const std::string difference = saved.has_build() ? BuildDifference(options_.build, saved.build()) : "";
  const std::uint64_t order = jobs_.contains(saved.order()) ? next_order_ : saved.order();
  next_order_ = std::max(next_order_, order + 1);
  orders_[saved.job_id()] = order;
  touched_.insert(order);
  Job& job = jobs_[order];
  job.id = saved.job_id();
  job.order = order;
  job.owner = saved.owner();
  job.SetSpec(saved.job());
  job.state = saved.state();
  job.reason = saved.reason();
  job.input_error = saved.input_error();
  job.held = saved.held();
  job.stage = saved.stage();
  job.round = saved.round();
  if (saved.has_step()) job.step = saved.step();
  for (const std::string& result : saved.results()) job.results.push_back(Hash::FromBinary(result).value());
  if (saved.has_build()) job.build = saved.build();
  job.facts.assign(saved.facts().begin(), saved.facts().end());
  job.seconds_before = saved.seconds();
  job.ended_served_s = saved.ended_served_s();
  served_from_s_ = std::min(served_from_s_, now_s_ - job.ended_served_s);  // where what Served says was lost
  job.running_since_s = now_s_;
  job.saving.number = saved.number();
  job.saving.durable = true;
  // The first answer is saved at once: a run that is killed again and again within an interval gets on too.
  job.saving.last_s = now_s_ - options_.checkpoint_interval_s;
  actions_.push_back(JobChanged{job.id});
  // What nobody holds below was kept for an older checkpoint only.
  for (const std::string& blob : saved.blobs()) ledger_.Offer(Hash::FromBinary(blob).value());
  for (const Hash& blob : event.previous_blobs) ledger_.Offer(blob);
  if (job.Final() || !CheckJob(job.spec).empty()) return;
  HoldRestored(job, event);
  BeginAgain(job);
  if (job.Ended()) return;
  TakeUpPartials(job, saved);
  if (!job.held) {
    job.state = difference.empty() ? proto::JOB_RUNNING : proto::JOB_PAUSED;
    job.reason = difference.empty() ? "" : "it was begun by another build: " + difference;
  }
  Say(job.Running() || job.held ? Report::kInfo : Report::kWarning, job,
      "the coordinator was started again: " +
          (job.Running() ? "goes on" + Whereabouts(job) : "stays paused: " + job.reason));
  // All but its end was saved, by a command while that could not be.
  if (job.Running() && job.AllStagesDone()) WantSave(job, true);
}

// What the round had when it was saved need not be computed again.
void Core::TakeUpPartials(Job& job, const proto::Checkpoint& saved) {
  job.saving.with_partials = true;  // what was saved of a round stays saved, and its first answer is worth it
  if (saved.partials_size() != static_cast<int>(job.partials.size())) return;
  for (std::uint32_t task = 0; task < job.partials.size(); ++task) {
    const Result<Hash> partial = Hash::FromBinary(saved.partials(static_cast<int>(task)));
    if (!partial.ok()) continue;
    job.partials[task] = partial.value();
    ledger_.Add(job.holds.partials, partial.value());
    job.tasks.Finish(task, partial.value());
  }
  if (!job.partials.empty() && job.tasks.AllDone()) job.tasks = Round::OfPlan(wire::TaskKey::ADVANCE);
}

void Core::HoldRestored(Job& job, const RestoreJob& event) {
  for (const auto& [name, hash] : job.spec.input_blobs()) {
    const Result<Hash> input = Hash::FromBinary(hash);
    if (input.ok()) ledger_.Add(job.holds.inputs, input.value());
  }
  for (const Hash& result : job.results) ledger_.Add(job.holds.results, result);
  if (job.step) ledger_.Replace(job.holds.step, BlobsOfStep(*job.step));
  for (const std::string& blob : event.checkpoint.blobs())
    ledger_.Add(job.holds.saved, Hash::FromBinary(blob).value());
  for (const Hash& blob : event.previous_blobs) ledger_.Add(job.holds.saved_before, blob);
}

void Core::ReleaseAll(Job& job) {
  for (BlobLedger::Hold* hold : {&job.holds.inputs, &job.holds.results, &job.holds.step, &job.holds.partials,
                                 &job.holds.saving, &job.holds.saved, &job.holds.saved_before})
    ledger_.Release(*hold);
}

// It stays as it is until the disk has forgotten it.
void Core::Delete(Job& job) {
  if (job.leaving) return;
  job.leaving = true;
  actions_.push_back(JobChanged{job.id});
  actions_.push_back(ForgetJob{job.id});
}

void Core::On(const ForgetDone& event) {
  Job* job = FindById(event.job);
  if (job == nullptr || !job->leaving) return;
  const std::vector<std::string> deleters = std::move(job->deleters);
  Erase(*job);
  for (const std::string& asker : deleters) Tell(asker, event.job, "");
}

void Core::On(const ForgetFailed& event) {
  Job* job = FindById(event.job);
  if (job == nullptr || !job->leaving) return;
  job->leaving = false;
  actions_.push_back(JobChanged{job->id});
  job->saving.not_before_s = now_s_ + options_.save_again_s;  // of what is only too old
  Say(Report::kWarning, *job, "cannot be deleted: " + event.reason);
  for (const std::string& asker : std::exchange(job->deleters, {}))
    TellUnable(asker, job->id, "cannot delete " + job->id + ": " + event.reason);
}

void Core::Erase(Job& job) {
  ReleaseAll(job);
  actions_.push_back(JobChanged{job.id});
  const std::uint64_t order = job.order;
  orders_.erase(job.id);
  jobs_.erase(order);
}

// Once its end is durable.
void Core::DeleteTheOld() {
  std::vector<Job*> old;
  for (auto& [order, job] : jobs_)
    if (job.Ended() && !job.leaving && !job.saving.due && !job.saving.under_way &&
        now_s_ >= job.saving.not_before_s && served_s() - job.ended_served_s > options_.keep_s)
      old.push_back(&job);
  for (Job* job : old) {
    Say(Report::kInfo, job->id + " is deleted: it ended " + Days(served_s() - job->ended_served_s) +
                           " ago, and jobs are kept for " + Days(options_.keep_s) + " (--keep-days)");
    Delete(*job);
  }
}

}  // namespace cairn::coordinator
