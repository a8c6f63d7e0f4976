#include "tests/simulation/checks.h"

#include <algorithm>

#include "tests/simulation/world.h"

namespace cairn::simulation {

using namespace coordinator;  // NOLINT: events and actions, all over this file

namespace {

std::string Text(const std::pair<std::uint32_t, std::uint64_t>& place) {
  return "stage " + std::to_string(place.first) +
         (place.second == 0 ? " before its start" : " round " + std::to_string(place.second - 1));
}

std::string Text(proto::JobState state) { return proto::JobState_Name(state); }

template <typename T>
bool Concerns(const Event& event, const std::string& id) {
  const T* is = std::get_if<T>(&event);
  if constexpr (requires { is->number; })
    return is != nullptr && is->job == id;
  else
    return is != nullptr && is->id == id;
}

// The transitions that there are, and what may cause each.
bool MayMove(const std::string& id, proto::JobState from, proto::JobState to, const Event& event) {
  const bool open = from == proto::JOB_RUNNING || from == proto::JOB_PAUSED;
  switch (to) {
    case proto::JOB_DONE:
      return from == proto::JOB_RUNNING && Concerns<PersistDone>(event, id);
    case proto::JOB_PAUSED:
      if (Concerns<PersistFailed>(event, id))  // also of a cancel, which is taken back
        return from == proto::JOB_RUNNING || from == proto::JOB_CANCELLED;
      return from == proto::JOB_RUNNING && Concerns<PauseJob>(event, id);
    case proto::JOB_CANCELLED:
      return from != proto::JOB_DONE && Concerns<CancelJob>(event, id);
    case proto::JOB_FAILED:
      if (Concerns<PersistFailed>(event, id))
        return from != proto::JOB_DONE;  // a retry or cancel is taken back
      return open && (std::holds_alternative<TaskDone>(event) || std::holds_alternative<TaskFailed>(event) ||
                      std::holds_alternative<WorkerLost>(event) || std::holds_alternative<Tick>(event) ||
                      std::holds_alternative<WorkerHello>(event));  // one too many
    default:
      return from == proto::JOB_PAUSED ? Concerns<ResumeJob>(event, id)
                                       : from == proto::JOB_FAILED && Concerns<RetryJob>(event, id);
  }
}

Mark MarkOf(proto::JobState from, proto::JobState to) {
  const bool paused = from == proto::JOB_PAUSED;
  switch (to) {
    case proto::JOB_DONE:
      return kDone;
    case proto::JOB_PAUSED:
      return kPaused;
    case proto::JOB_CANCELLED:
      return paused ? kCancelledFromPause : kCancelledJob;
    case proto::JOB_FAILED:
      return paused ? kFailedPaused : kFailed;
    default:
      return paused ? kWokePaused : kWokeFailed;
  }
}

}  // namespace

Checks::Place Checks::PlaceOf(const proto::Checkpoint& checkpoint) {
  return {checkpoint.stage(), checkpoint.has_step() ? checkpoint.round() + 1 : 0};
}

void Checks::AddJob(const std::string& id, const proto::Job& job, ToyKind kind) {
  Known& known = jobs_[id];
  known.kind = kind;
  known.stages = static_cast<std::uint32_t>(job.stages_size());
  if (kind != ToyKind::kHopeless) known.truth = RunToy(job);
}

void Checks::Before(const Core& core, const Event& event) {
  alarm_ = Alarm::kNever;
  broken_ = {};
  if (const auto* done = std::get_if<TaskDone>(&event)) {
    Weigh(core, *done);
    NoteMalformed(core, *done);
  }
  retries_before_ = Retries(core);
  NoteLost(core, event);
  NoteRunning(core, event);
  ready_before_.clear();
  for (const auto& [id, known] : jobs_)
    if (const Job* job = core.FindJob(id); job != nullptr && job->Running() && job->tasks.HasReady())
      ready_before_.insert(id);
}

void Checks::After(const Core& core, const Event& event, const std::vector<Action>& actions,
                   std::uint64_t process, double now_s) {
  if (process != std::exchange(process_, process)) ForgetWorkers();
  for (auto& [id, known] : jobs_) {
    const proto::JobState before = known.state;
    const Job* job = core.FindJob(id);
    const bool told = std::any_of(actions.begin(), actions.end(), [&job_id = id](const Action& action) {
      const auto* changed = std::get_if<JobChanged>(&action);
      return changed != nullptr && changed->job == job_id;
    });
    const bool leaves = job != nullptr && job->leaving;
    const bool went = known.process == process && (job == nullptr || leaves != known.leaving);
    if (went && !told) Fail(id + " goes or stays, and nobody was told");
    known.leaving = leaves;
    if (job == nullptr) {
      known.process = 0;  // refused, or deleted: where it comes again, it begins anew
      continue;
    }
    See(*job, event, process);
    if (job->state != before && !told) Fail(id + " changed its state, and nobody was told");
  }
  SeeOrders(core, event);
  SeeAlarms(actions);
  SeeTables(core, std::holds_alternative<Tick>(event), now_s);
  if (const auto* heartbeat = std::get_if<WorkerHeartbeat>(&event)) SeeHeartbeat(core, *heartbeat, now_s);
  SeeDraining(core, event, actions);
  SeeBack(core, event);
  SeeSilent(core);
  SeeStandstill(core, std::holds_alternative<Tick>(event), now_s);
  SeeExcluded(core, actions);
  SeeTurns(core, actions);
  CountActions(core, actions);
}

void Checks::See(const Job& job, const Event& event, std::uint64_t process) {
  Known& known = jobs_.at(job.id);
  const Place place{job.stage, job.step ? job.round + 1 : 0};
  if (process != known.process) {
    known.process = process;
    known.passed_over = 0;
    if (const auto* restore = std::get_if<RestoreJob>(&event)) {
      SeeRestored(job, restore->checkpoint, known);
    } else {
      if (known.durable_number > 0) Fail(job.id + " was durable, and has to be submitted again");
      known.state = proto::JOB_RUNNING;
    }
  } else if (place != known.seen) {
    const bool next_round = place == Place{known.seen.first, known.seen.second + 1};
    const bool next_stage = place == Place{known.seen.first + 1, 0};
    if (!next_round && !next_stage) Fail(job.id + " went from " + Text(known.seen) + " to " + Text(place));
    world_.Count(next_stage ? kStageEnded : kRoundEnded);
  }
  known.seen = place;
  SeeState(job, event, known);
  SeeTruth(job, known);
}

void Checks::SeeRestored(const Job& job, const proto::Checkpoint& saved, Known& known) {
  if (saved.number() < known.durable_number)
    Fail(job.id + " came back from checkpoint " + std::to_string(saved.number()) + ", durable was " +
         std::to_string(known.durable_number));
  const Place place{job.stage, job.step ? job.round + 1 : 0};
  if (place != PlaceOf(saved))
    Fail(job.id + " came back at " + Text(place) + ", saved was " + Text(PlaceOf(saved)));
  if (place < known.durable && saved.state() != proto::JOB_CANCELLED)
    Fail(job.id + " came back at " + Text(place) + ", durable was " + Text(known.durable));
  if (saved.held() != job.held || (saved.held() && job.state != proto::JOB_PAUSED))
    Fail(job.id + " was paused by its owner, and came back otherwise");
  if (saved.job().priority() != job.spec.priority()) Fail(job.id + " came back with another priority");
  if (saved.partials_size() > 0) world_.Count(kRestoredWithPartials);
  if (saved.number() > known.durable_number) {
    // What a start reads is durable, though the process that wrote it did not live to hear so.
    known.durable_number = saved.number();
    known.durable_state = saved.state();
    if (saved.state() != proto::JOB_CANCELLED) known.durable = PlaceOf(saved);
  }
  known.state = saved.state();
  // It goes on by itself, or says why not.
  if (saved.state() == proto::JOB_RUNNING || saved.state() == proto::JOB_PAUSED) known.state = job.state;
}

void Checks::SeeState(const Job& job, const Event& event, Known& known) {
  const bool hopeless = known.kind == ToyKind::kHopeless && Concerns<SubmitJob>(event, job.id);
  if (job.state != known.state) {
    if (!MayMove(job.id, known.state, job.state, event) && !hopeless)
      Fail(job.id + " went from " + Text(known.state) + " to " + Text(job.state) + " by " + Describe(event));
    world_.Count(MarkOf(known.state, job.state));
    if (job.state == proto::JOB_FAILED) {
      if (job.input_error) world_.Count(kInputError);
      const auto* failed = std::get_if<TaskFailed>(&event);
      const bool asked = failed != nullptr && world_.shell().WasGiven(failed->peer, failed->failed.key());
      // A lie that a worker may tell of a task that it was given: the job's owner may try again.
      if (job.input_error && asked && failed->failed.message() == "a lie") known.deceived = true;
      const bool taken_back = Concerns<PersistFailed>(event, job.id);  // a retry: so it had failed before
      if (job.input_error && known.kind == ToyKind::kGood && !asked && !taken_back)
        Fail(job.id + " is blamed for its input, which is good: " + job.reason);
      if (world_.faults.night && known.kind == ToyKind::kGood)
        Fail(job.id + " failed, though only machines were lost: " + job.reason);
      if (job.reason.find(" times") != std::string::npos) world_.Count(kThirdFailure);
    }
    if (job.state == proto::JOB_DONE && known.durable_state != proto::JOB_DONE)
      Fail(job.id + " is done before its end is durable");
  }
  known.state = job.state;
  if (!job.Running() && job.state != proto::JOB_DONE && job.reason.empty())
    Fail(job.id + " waits or has ended, and says no reason");
}

// What a user orders happens at once.
void Checks::SeeOrders(const Core& core, const Event& event) {
  if (const auto* cancel = std::get_if<CancelJob>(&event)) {
    const Job* job = core.FindJob(cancel->id);
    if (job != nullptr && !job->Ended()) Fail(cancel->id + " was cancelled and goes on");
  }
  if (const auto* resume = std::get_if<ResumeJob>(&event)) {
    const Job* job = core.FindJob(resume->id);
    if (job != nullptr && job->state == proto::JOB_PAUSED)
      Fail(resume->id + " was resumed and does not go on: " + job->reason);
  }
  if (const auto* retry = std::get_if<RetryJob>(&event)) {
    const Job* job = core.FindJob(retry->id);
    if (job != nullptr && !job->leaving && jobs_.at(retry->id).kind != ToyKind::kHopeless &&
        job->state == proto::JOB_FAILED)
      Fail(retry->id + " was retried and does not go on: " + job->reason);
  }
  if (const auto* pause = std::get_if<PauseJob>(&event)) {
    const Job* job = core.FindJob(pause->id);
    if (job != nullptr && job->Running() && !job->AllStagesDone())
      Fail(pause->id + " was paused and goes on");
  }
}

void Checks::SeeDurable(const proto::Checkpoint& checkpoint) {
  Known& known = jobs_.at(checkpoint.job_id());
  if (checkpoint.number() <= known.durable_number) Fail("a checkpoint's number does not grow");
  if (checkpoint.state() == proto::JOB_CANCELLED) {  // where it stood is told by nothing any more
    if (checkpoint.blobs_size() > 0) Fail(checkpoint.job_id() + " is cancelled and keeps blobs");
  } else {
    if (PlaceOf(checkpoint) < known.durable)
      Fail(checkpoint.job_id() + " saved an earlier round after a later one");
    known.durable = PlaceOf(checkpoint);
  }
  known.durable_number = checkpoint.number();
  known.durable_state = checkpoint.state();
  if (checkpoint.state() == proto::JOB_DONE && known.published.size() != known.stages)
    Fail(checkpoint.job_id() + " is done before its results are published");
}

void Checks::SeeDamaged(const proto::Checkpoint& checkpoint) {
  Known& known = jobs_.at(checkpoint.job_id());
  known.durable = PlaceOf(checkpoint);
  known.durable_number = checkpoint.number();
  known.durable_state = checkpoint.state();
}

void Checks::SeeLost(const std::string& id) {
  if (jobs_.at(id).durable_number > 0) Fail(id + " is lost: none of its checkpoints can be read");
}

void Checks::SeeResult(const std::string& id, std::uint32_t stage, const Hash& result) {
  Known& known = jobs_.at(id);
  if (!known.deceived && known.truth.results.at(stage) != result)
    Fail(id + " published another result than the undisturbed job's");
  known.published[stage] = result;
}

// More blobs than this nobody can need: inputs and results; partials, shared, kept and shown blobs of the
// step, of two checkpoints, and of the one under way.
void Checks::SeeMemory(std::size_t blobs) {
  std::size_t most = 0;
  for (const auto& [id, known] : jobs_) most += 1 + known.stages + 4 * (known.truth.most_tasks + 3);
  if (blobs > most) Fail(std::to_string(blobs) + " blobs in memory, more than " + std::to_string(most));
}

void Checks::SeeEnd(const Job& job, const proto::Checkpoint* saved, bool given_up) {
  const Known& known = jobs_.at(job.id);
  const std::string how = job.id + " ended as " + Text(job.state) + " (" + job.reason + ")";
  if (saved == nullptr || saved->state() != job.state) Fail(how + ", which is not what is saved");
  if (given_up && job.Ended()) return;
  if (known.deceived) return;  // where a lie leads to is not known
  if (known.kind == ToyKind::kHopeless || known.kind == ToyKind::kBadInput) {
    if (!job.input_error) Fail(how + ", which does not blame its input");
  } else if (known.kind == ToyKind::kPoisoned) {
    if (job.reason.find("failed 3 times") == std::string::npos) Fail(how + ", not by its third failure");
  } else if (job.state != proto::JOB_DONE) {
    Fail(how);
  } else if (known.published.size() != known.stages) {
    Fail(how + ", but not all its results are published");
  }
}

}  // namespace cairn::simulation
