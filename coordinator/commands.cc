// What a job's owner tells it. job_commands.h says what is allowed when; what is not allowed changes nothing.
#include <algorithm>

#include "coordinator/core.h"
#include "coordinator/job_commands.h"

namespace cairn::coordinator {

Job* Core::Obeying(const std::string& id, JobCommand command) {
  Job* job = FindById(id);
  return job != nullptr && WhyNot(*job, command).empty() ? job : nullptr;
}

// What workers have in hand of it is finished and counts; nothing more is handed out.
void Core::On(const PauseJob& event) {
  Job* job = Obeying(event.id, JobCommand::kPause);
  if (job == nullptr || job->held) return;
  SetState(*job, proto::JOB_PAUSED, "paused by its owner");
  Say(Report::kInfo, *job, job->reason);
  job->held = true;
  WantSave(*job, true);
}

void Core::On(const ResumeJob& event) {
  Job* job = Obeying(event.id, JobCommand::kResume);
  if (job == nullptr || job->Running() || !IsOfThisBuild(*job)) return;
  // What it stood still for is no part of its round's time.
  job->round_since_s = std::min(now_s_, job->round_since_s + now_s_ - job->running_since_s);
  GoOn(*job, "resumed");
}

void Core::On(const RetryJob& event) {
  Job* job = Obeying(event.id, JobCommand::kRetry);
  if (job == nullptr || !IsOfThisBuild(*job)) return;
  BeginAgain(*job);
  GoOn(*job, "retried");
}

bool Core::IsOfThisBuild(Job& job) {
  if (!job.build || BuildDifference(options_.build, *job.build).empty()) return true;
  job.reason = "it was begun by another build: " + BuildDifference(options_.build, *job.build);
  Say(Report::kWarning, job, "cannot go on: " + job.reason);
  return false;
}

void Core::GoOn(Job& job, const std::string& how) {
  SetState(job, proto::JOB_RUNNING, "");
  job.failures.clear();
  Say(Report::kInfo, job, how + Whereabouts(job));
  WantSave(job, true);
}

// For good: once that is durable its blobs go.
void Core::On(const CancelJob& event) {
  Job* job = Obeying(event.id, JobCommand::kCancel);
  if (job == nullptr || job->state == proto::JOB_CANCELLED) return;
  WithdrawAll(*job);
  ledger_.Release(job->holds.partials);
  SetState(*job, proto::JOB_CANCELLED, "cancelled");
  Say(Report::kInfo, *job, "cancelled");
  WantSave(*job, true);
}

void Core::On(const DeleteJob& event) {
  Job* job = Obeying(event.id, JobCommand::kDelete);
  if (job != nullptr) Delete(*job);
}

void Core::On(const PrioritizeJob& event) {
  Job* job = Obeying(event.id, JobCommand::kPrioritize);
  if (job == nullptr || event.priority == job->spec.priority()) return;
  if (event.priority < kLowestPriority || event.priority > kHighestPriority) return;
  Say(Report::kInfo, *job,
      "priority " + std::to_string(event.priority) + " instead of " + std::to_string(job->spec.priority()));
  job->spec.set_priority(event.priority);
  actions_.push_back(JobChanged{job->id});
  WantSave(*job, true);
}

}  // namespace cairn::coordinator
