// What a job's owner tells it. job_commands.h says what is allowed when; what is not allowed changes nothing,
// nor does what cannot be made durable: whoever asked for it is refused, and it is taken back.
#include <algorithm>

#include "coordinator/core/core.h"
#include "coordinator/core/job_commands.h"

namespace cairn::coordinator {

void Core::Tell(const std::string& asker, const std::string& job, const std::string& refusal, bool known) {
  if (!asker.empty()) actions_.push_back(Answer{asker, job, refusal, known});
}

void Core::TellUnable(const std::string& asker, const std::string& job, const std::string& refusal) {
  if (!asker.empty()) actions_.push_back(Answer{asker, job, refusal, false, true});
}

void Core::AnswerWhenSaved(Job& job, const std::string& asker, const Standing& before) {
  if (!asker.empty()) job.pending.push_back({asker, job.saving.number + 1, before, false});
}

void Core::AnswerAsItStands(Job& job, const std::string& asker, bool known) {
  const Saving& saving = job.saving;
  if (asker.empty()) return;
  if (!job.pending.empty())
    job.pending.push_back({asker, job.pending.back().number, job.Stands(), known});
  else if (!saving.durable && saving.under_way)
    job.pending.push_back({asker, saving.number, job.Stands(), known});
  else if (saving.durable)
    Tell(asker, job.id, "", known);
  else
    TellUnable(asker, job.id, job.reason);
}

void Core::AnswerDurable(Job& job, std::uint64_t number) {
  for (; !job.pending.empty() && job.pending.front().number <= number; job.pending.pop_front())
    Tell(job.pending.front().asker, job.id, "", job.pending.front().known);
}

// All of them, those that wait for the next checkpoint too: what they were allowed was of a job that is no
// more.
void Core::RefusePending(Job& job, const std::string& why) {
  if (job.pending.empty()) return;
  const std::deque<PendingCommand> pending = std::exchange(job.pending, {});
  for (const PendingCommand& command : pending)
    TellUnable(command.asker, job.id, why + "; " + job.id + " is as it was before");
  Undo(job, pending.front().before);
}

void Core::RefuseSubmission(Job& job, const std::string& why) {
  const std::deque<PendingCommand> pending = std::exchange(job.pending, {});
  const std::string id = job.id;
  WithdrawAll(job);
  Erase(job);
  actions_.push_back(ForgetJob{id});
  for (const PendingCommand& command : pending)
    TellUnable(command.asker, id, why + "; the job was not taken");
}

// But for what the job did by itself since: one that has failed, or is done, stays so.
void Core::Undo(Job& job, const Standing& before) {
  share_.Reprioritize(job.order, job.spec.priority(), before.priority);
  job.spec.set_priority(before.priority);
  actions_.push_back(JobChanged{job.id});
  const bool by_itself = job.state == proto::JOB_FAILED || job.state == proto::JOB_DONE;
  if (by_itself || (job.state == before.state && job.held == before.held)) return;
  if (before.state == proto::JOB_FAILED) {
    WithdrawAll(job);
    ledger_.Release(job.holds.partials);
  }
  SetState(job, before.state, before.reason);
  job.input_error = before.input_error;
  job.held = before.held;
  job.failures = before.failures;
  job.ended_served_s = before.ended_served_s;
}

Job* Core::Obeying(const std::string& id, JobCommand command, const std::string& asker) {
  Job* job = FindById(id);
  const std::string why = job == nullptr ? "there is no job '" + id + "'" : WhyNot(*job, command);
  if (why.empty()) return job;
  Tell(asker, id, why);
  return nullptr;
}

// What workers are assigned of it is finished and counts; nothing more is dispatched.
void Core::On(const PauseJob& event) {
  Job* job = Obeying(event.id, JobCommand::kPause, event.asker);
  if (job == nullptr) return;
  if (job->held) return AnswerAsItStands(*job, event.asker);
  AnswerWhenSaved(*job, event.asker, job->Stands());
  SetState(*job, proto::JOB_PAUSED, "paused by " + (event.by.empty() ? "its owner" : event.by));
  Say(Report::kInfo, *job, event.by.empty() ? job->reason : "paused");
  job->held = true;
  WantSave(*job, true);
}

void Core::On(const ResumeJob& event) {
  Job* job = Obeying(event.id, JobCommand::kResume, event.asker);
  if (job == nullptr) return;
  if (job->Running()) return AnswerAsItStands(*job, event.asker);
  if (!IsOfThisBuild(*job)) return Tell(event.asker, job->id, "cannot go on: " + job->reason);
  AnswerWhenSaved(*job, event.asker, job->Stands());
  // What it stood still for is no part of its round's time.
  const double still_s = now_s_ - job->running_since_s;
  job->round_since_s = std::min(now_s_, job->round_since_s + still_s);
  job->eta.Skip(still_s, now_s_);
  GoOn(*job, "resumed");
}

void Core::On(const RetryJob& event) {
  Job* job = Obeying(event.id, JobCommand::kRetry, event.asker);
  if (job == nullptr) return;
  if (!IsOfThisBuild(*job)) return Tell(event.asker, job->id, "cannot go on: " + job->reason);
  AnswerWhenSaved(*job, event.asker, job->Stands());
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

// For good: once that is durable its blobs go. Until then it may have to go on.
void Core::On(const CancelJob& event) {
  Job* job = Obeying(event.id, JobCommand::kCancel, event.asker);
  if (job == nullptr) return;
  if (job->state == proto::JOB_CANCELLED) return AnswerAsItStands(*job, event.asker);
  AnswerWhenSaved(*job, event.asker, job->Stands());
  WithdrawAll(*job);
  SetState(*job, proto::JOB_CANCELLED, "cancelled");
  Say(Report::kInfo, *job, "cancelled");
  WantSave(*job, true);
}

void Core::On(const DeleteJob& event) {
  Job* job = Obeying(event.id, JobCommand::kDelete, event.asker);
  if (job == nullptr) return;
  if (!event.asker.empty()) job->deleters.push_back(event.asker);
  Delete(*job);
}

void Core::On(const PrioritizeJob& event) {
  Job* job = Obeying(event.id, JobCommand::kPrioritize, event.asker);
  if (job == nullptr) return;
  if (event.priority < kLowestPriority || event.priority > kHighestPriority)
    return Tell(event.asker, event.id, "a priority is a number from -10 to 10");
  if (event.priority == job->spec.priority()) return AnswerAsItStands(*job, event.asker);
  AnswerWhenSaved(*job, event.asker, job->Stands());
  Say(Report::kInfo, *job,
      "priority " + std::to_string(event.priority) + " instead of " + std::to_string(job->spec.priority()));
  share_.Reprioritize(job->order, job->spec.priority(), event.priority);
  job->spec.set_priority(event.priority);
  actions_.push_back(JobChanged{job->id});
  WantSave(*job, true);
}

}  // namespace cairn::coordinator
