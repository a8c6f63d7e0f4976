// What users are told: nothing that the store does not have, and what they are refused did not happen.
#include "tests/simulation/checks.h"
#include "tests/simulation/world.h"

namespace cairn::simulation {

using coordinator::Core;
using coordinator::Job;

std::string Checks::Ask(Asked::What what, const std::string& id, int priority) {
  const std::string asker = "user" + std::to_string(++questions_);
  asked_[asker] = {what, id, priority};
  jobs_.at(id).asker = asker;
  jobs_.at(id).deletion_asked |= what == Asked::kDelete;
  return asker;
}

void Checks::SeeAnswer(const Core& core, const coordinator::Answer& answer, const proto::Checkpoint* saved) {
  const auto asked = asked_.find(answer.asker);
  if (asked == asked_.end() || asked->second.id != answer.job) return Fail("an answer to nobody's question");
  const Asked question = asked->second;
  asked_.erase(asked);  // nobody is answered twice
  if (answer.refusal.empty())
    SeeDone(question, answer.asker, core, saved);
  else
    SeeRefused(question, core, saved);
}

void Checks::SeeDone(const Asked& asked, const std::string& asker, const Core& core,
                     const proto::Checkpoint* saved) {
  world_.Count(kAcknowledged);
  Known& known = jobs_.at(asked.id);
  if (asked.what == Asked::kDelete) {
    known.gone = true;
    if (saved != nullptr) Fail(asked.id + " is said to be deleted, and lies in the store");
    return;
  }
  if (known.durable_number == 0 || saved == nullptr)
    return Fail(asked.id + " was acknowledged, and is not durable");
  const std::uint64_t number = NumberOf(saved->job());
  for (const auto& [id, other] : jobs_)
    if (id != asked.id && other.number == number)
      Fail(asked.id + " has the number that " + id + " was given");
  known.number = number;
  if (known.asker != asker) return;  // what was asked later may hold already
  const bool failed = saved->state() == proto::JOB_FAILED;
  const Job* job = core.FindJob(asked.id);
  if ((asked.what == Asked::kCancel && saved->state() != proto::JOB_CANCELLED) ||
      (asked.what == Asked::kPause && !saved->held() && !failed) ||
      (asked.what == Asked::kResume && saved->held()) ||
      // What was asked before may come later, and hold in memory already.
      (asked.what == Asked::kPrioritize && job != nullptr && saved->job().priority() != asked.priority &&
       saved->job().priority() != job->spec.priority()))
    Fail("what was asked of " + asked.id + " is said to be done, and is not saved");
}

void Checks::SeeRefused(const Asked& asked, const Core& core, const proto::Checkpoint* saved) {
  const Known& known = jobs_.at(asked.id);
  const Job* job = core.FindJob(asked.id);
  if (asked.what == Asked::kSubmit && known.durable_number == 0) {
    world_.Count(kSubmissionRefused);
    if (job != nullptr) Fail(asked.id + " was refused, and is there");
  }
  if (known.durable_number == 0) return;
  if (asked.what == Asked::kDelete && job != nullptr) world_.Count(kDeletionRefused);
  if (job == nullptr || saved == nullptr || !job->pending.empty() || job->leaving) return;
  if (asked.what != Asked::kDelete) world_.Count(kTakenBack);
  const bool failed = job->state == proto::JOB_FAILED;  // by itself, perhaps
  if ((job->state == proto::JOB_CANCELLED) != (saved->state() == proto::JOB_CANCELLED) ||
      (job->held != saved->held() && !failed) || job->spec.priority() != saved->job().priority())
    Fail("what was asked of " + asked.id + " was refused, and is not taken back");
}

void Checks::SeeStarted(const Core& core) {
  for (const auto& [id, known] : jobs_) {
    const bool there = core.FindJob(id) != nullptr;
    if (known.number > 0 && !known.deletion_asked && !there) Fail(id + " was acknowledged, and is gone");
    if (known.gone && there) Fail(id + " was said to be deleted, and is back");
  }
}

}  // namespace cairn::simulation
