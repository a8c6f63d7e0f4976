#include "tests/simulation/users.h"

#include <algorithm>

#include "tests/simulation/world.h"

namespace cairn::simulation {

using coordinator::CancelJob;
using coordinator::DeleteJob;
using coordinator::Job;
using coordinator::PauseJob;
using coordinator::PrioritizeJob;
using coordinator::ResumeJob;
using coordinator::RetryJob;
using coordinator::SubmitJob;

namespace {

constexpr int kPatience = 2;  // how often a user tries again what fails by itself

// Longer than any wait that heals by itself takes: leases, hung tasks, messages under way, slow workers.
double LongestWait(const Faults& faults) {
  const coordinator::CoreOptions& core = faults.core;
  return 60 + 2 * (core.plan_hung_s + core.hung_s + core.lease_s + core.unlisted_s) + 80 * faults.task_s +
         10 * faults.persist_s;
}

}  // namespace

void Users::Start() {
  for (int i = 0; i < world_.faults.jobs; ++i) Wants(ToyKind::kGood);
  if (world_.faults.bad_input) Wants(ToyKind::kBadInput);
  if (world_.faults.poisoned) Wants(ToyKind::kPoisoned);
  if (world_.faults.hopeless) Wants(ToyKind::kHopeless);
}

void Users::Wants(ToyKind kind) {
  const Faults& f = world_.faults;
  const std::string id = "job" + std::to_string(wishes_.size());
  Wish& wish = wishes_[id];
  wish.kind = kind;
  wish.job = MakeToyJob(world_.rng.Bits64() >> 8, f.stages, f.rounds, f.tasks, kind);
  world_.checks.AddJob(id, wish.job, kind);
  const double most_s = ids_.empty() && wishes_.size() == 1 ? 0.1
                        : world_.rng.Below(2) == 0          ? 10
                                                            : f.trouble_s;
  world_.schedule.After(world_.rng.Uniform(0, most_s), [this, id] {
    ids_.push_back(id);
    Submit(id);
  });
}

// Again until the job is durable.
void Users::Submit(const std::string& id) {
  const Wish& wish = wishes_.at(id);
  if (wish.deleted) return;
  const coordinator::Core* core = world_.shell().core();
  if (core != nullptr && (core->FindJob(id) == nullptr || world_.rng.Below(8) == 0)) {
    const bool again = core->FindJob(id) != nullptr;
    world_.Count(again ? kSubmittedTwice : kSubmitted);
    if (wish.kind == ToyKind::kHopeless) world_.Count(kSubmittedHopeless);
    SubmitJob event{id, wish.job, {}, world_.checks.Ask(Asked::kSubmit, id)};
    for (const auto& [name, hash] : wish.job.input_blobs())
      event.blobs.push_back(Hash::FromBinary(hash).value());
    if (world_.faults.embedded)
      world_.shell().Deliver(event);
    else
      world_.uploaders.Begin(event);
  }
  if (world_.shell().store().Newest(id) == nullptr) world_.schedule.After(3, [this, id] { Submit(id); });
}

void Users::Cancel(const std::string& id, Wish& wish) {
  const coordinator::Core* core = world_.shell().core();
  const Job* job = core == nullptr ? nullptr : core->FindJob(id);
  if (job == nullptr || job->Ended()) return;
  world_.Count(job->Running() ? kCancelled : kCancelledPaused);
  if (world_.shell().store().Newest(id) == nullptr) world_.Count(kCancelledUnsaved);
  wish.given_up = true;
  world_.shell().Deliver(CancelJob{id, world_.checks.Ask(Asked::kCancel, id)});
}

void Users::Disturb() {
  for (const std::string& id : ids_) {
    Wish& wish = wishes_.at(id);
    // What is not yet durable is so for a moment only: more often then, or it would hardly come up.
    const bool unsaved = world_.shell().store().Newest(id) == nullptr;
    if (world_.Chance(world_.faults.cancel_per_s * (unsaved ? 10 : 1))) Cancel(id, wish);
    if (world_.Chance(world_.faults.delete_per_s)) Delete(id, wish);
    if (world_.Chance(world_.faults.pause_per_s)) Pause(id);
    if (world_.Chance(world_.faults.prioritize_per_s)) {
      world_.Count(kPrioritized);
      const int priority = static_cast<int>(world_.rng.Below(25)) - 12;
      world_.shell().Deliver(
          PrioritizeJob{id, priority, world_.checks.Ask(Asked::kPrioritize, id, priority)});
    }
    if (world_.rng.Below(4) == 0) ResumeIfStopped(id);
    if (world_.rng.Below(100) == 0) Submit(id);
  }
  if (world_.rng.Below(10) != 0) return;
  world_.Count(kSavedNow);
  world_.shell().Deliver(coordinator::SaveNow{});
}

void Users::Pause(const std::string& id) {
  const coordinator::Core* core = world_.shell().core();
  const Job* job = core == nullptr ? nullptr : core->FindJob(id);
  if (job != nullptr && job->Running()) world_.Count(kHeld);
  world_.shell().Deliver(PauseJob{id, world_.checks.Ask(Asked::kPause, id)});
}

// What has ended, and again until it is gone.
void Users::Delete(const std::string& id, Wish& wish) {
  const coordinator::Core* core = world_.shell().core();
  const Job* job = core == nullptr ? nullptr : core->FindJob(id);
  const proto::Checkpoint* saved = world_.shell().store().Newest(id);
  if (job == nullptr || saved == nullptr) return;
  if (!wish.deleted && (!job->Ended() || saved->state() != job->state)) return;
  world_.Count(kDeleted);
  wish.deleted = true;
  world_.shell().Deliver(DeleteJob{id, world_.checks.Ask(Asked::kDelete, id)});
}

void Users::ResumeIfStopped(const std::string& id) {
  Wish& wish = wishes_.at(id);
  const coordinator::Core* core = world_.shell().core();
  const Job* job = core == nullptr ? nullptr : core->FindJob(id);
  if (job == nullptr || job->Running() || job->Final() || wish.given_up || wish.deleted) return;
  if (job->input_error && wish.kind != ToyKind::kGood) return;
  if (world_.healed() && wish.kind == ToyKind::kPoisoned && job->state == proto::JOB_FAILED &&
      wish.resumed++ >= kPatience)
    return;
  if (job->state == proto::JOB_FAILED) {
    world_.Count(kRetried);
    return world_.shell().Deliver(RetryJob{id, world_.checks.Ask(Asked::kRetry, id)});
  }
  world_.Count(kResumed);
  world_.shell().Deliver(ResumeJob{id, world_.checks.Ask(Asked::kResume, id)});
}

void Users::BringToAnEnd() {
  for (const std::string& id : ids_) {
    Wish& wish = wishes_.at(id);
    if (wish.deleted) {  // where the store lost its end it is back, and must end again first
      Cancel(id, wish);
      Delete(id, wish);
    }
    // Where a lie leads to is not known: it may be rounds without end.
    if (world_.checks.Deceived(id) && world_.schedule.now_s() > 3 * world_.faults.trouble_s)
      wish.given_up = true;
    if (wish.given_up) Cancel(id, wish);
    ResumeIfStopped(id);
    CheckThatItMoves(id, wish);
  }
}

// Nothing starves and nothing is forgotten: once all is healed a job that is wanted does not stand still.
void Users::CheckThatItMoves(const std::string& id, Wish& wish) {
  const coordinator::Core* core = world_.shell().core();
  const Job* job = core == nullptr ? nullptr : core->FindJob(id);
  const double now_s = world_.schedule.now_s();
  if (job == nullptr || wish.deleted || IsOver(*job, wish) || wish.moved_s == 0) {
    wish.moved_s = now_s;
    return;
  }
  const auto known = std::count_if(job->partials.begin(), job->partials.end(),
                                   [](const Hash& partial) { return !partial.empty(); });
  const std::tuple stands{job->stage, job->round + (job->step ? 1 : 0), static_cast<std::size_t>(known),
                          static_cast<int>(job->state), job->saving.number};
  if (stands != wish.stood) {
    wish.stood = stands;
    wish.moved_s = now_s;
  } else if (now_s - wish.moved_s > LongestWait(world_.faults)) {
    world_.checks.Fail(id + " stands still for " + std::to_string(now_s - wish.moved_s) + " s: " + Summary());
  }
}

bool Users::IsOver(const Job& job, const Wish& wish) const {
  if (job.state == proto::JOB_DONE || (job.input_error && wish.kind != ToyKind::kGood)) return true;
  if (wish.given_up && job.Ended()) return true;
  return job.state == proto::JOB_FAILED && wish.kind == ToyKind::kPoisoned && wish.resumed > kPatience;
}

bool Users::AllEnded() const {
  const coordinator::Core* core = world_.shell().core();
  return core != nullptr && !core->HasUnsaved() && ids_.size() == wishes_.size() &&
         std::all_of(wishes_.begin(), wishes_.end(), [&](const auto& entry) {
           const Job* job = core->FindJob(entry.first);
           if (entry.second.deleted) return job == nullptr;
           return job != nullptr && IsOver(*job, entry.second);
         });
}

void Users::CheckEnd() const {
  const coordinator::Core& core = *world_.shell().core();
  bool all_done = true;
  for (const auto& [id, wish] : wishes_) {
    if (wish.deleted) continue;  // AllEnded has seen that it is gone
    const Job& job = *core.FindJob(id);
    world_.checks.SeeEnd(job, world_.shell().store().Newest(id), wish.given_up);
    all_done &= job.state == proto::JOB_DONE;
  }
  if (all_done && core.held_blobs() > 0) world_.checks.Fail("all jobs are done, but blobs are still held");
}

std::string Users::Summary() const {
  const coordinator::Core* core = world_.shell().core();
  if (core == nullptr) return "the coordinator is down";
  std::string text;
  for (const wire::JobInfo& info : core->Jobs()) text += info.ShortDebugString() + "; ";
  return text + std::to_string(core->fleet().size()) + " workers";
}

}  // namespace cairn::simulation
