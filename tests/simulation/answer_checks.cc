// What a job takes for true: the undisturbed job's partials, steps and results, unless a worker that was
// given the task lied in a way that nothing contradicts.
#include <algorithm>

#include "tests/simulation/checks.h"
#include "tests/simulation/world.h"

namespace cairn::simulation {

using namespace coordinator;  // NOLINT: events and actions, all over this file

namespace {

Hash ClaimOf(const TaskDone& event) {
  if (event.done.key().kind() != wire::TaskKey::RUN) return HashOfStep(event.done.step());
  const Result<Hash> hash = Hash::FromBinary(event.done.partial());
  return hash.ok() ? hash.value() : Hash{};
}

// The answer that the job has to that task; empty where it has none.
Hash KnownAnswer(const Job& job, const wire::TaskKey& key) {
  if (key.kind() != wire::TaskKey::RUN)
    return job.last_plan.kind() == key.kind() && SameTask(job.last_plan, key) ? job.last_plan_hash : Hash{};
  if (!job.step || key.stage() != job.stage || key.round() != job.round || key.task() >= job.partials.size())
    return Hash{};
  return job.partials[key.task()];
}

// Whether nothing but a second answer could tell that it is wrong.
bool IsWellFormed(const Core& core, const TaskDone& event) {
  const auto there = [&](const Hash& blob) {
    return core.Holds(blob) || std::find(event.blobs.begin(), event.blobs.end(), blob) != event.blobs.end();
  };
  if (event.done.key().kind() == wire::TaskKey::RUN)
    return there(ClaimOf(event)) &&
           std::all_of(event.blobs.begin(), event.blobs.end(),
                       [&event](const Hash& blob) { return blob == ClaimOf(event); });
  if (!event.done.has_step() || !CheckStep(event.done.step()).empty()) return false;
  const coordinator::HashSet blobs = BlobsOfStep(event.done.step());
  return std::all_of(blobs.begin(), blobs.end(), there);
}

}  // namespace

// Empty where there is no such task.
Hash Checks::TruthOf(const Known& known, const wire::TaskKey& key) const {
  const ToyTruth& truth = known.truth;
  if (key.stage() >= known.stages || key.stage() >= truth.ends.size()) return Hash{};
  const bool start = key.kind() == wire::TaskKey::START;
  const auto round = truth.rounds.find({key.stage(), key.round()});
  if (key.kind() == wire::TaskKey::RUN)
    return round != truth.rounds.end() && key.task() < round->second.partials.size()
               ? round->second.partials[key.task()]
               : Hash{};
  if (key.task() != 0 || (start ? key.round() != 0 : round == truth.rounds.end())) return Hash{};
  const auto next = truth.rounds.find({key.stage(), start ? 0 : key.round() + 1});
  return next == truth.rounds.end() ? truth.ends[key.stage()] : next->second.step;
}

// An answer of a wrong form that is waited for shows that its worker is broken.
void Checks::NoteMalformed(const Core& core, const TaskDone& event) {
  const Worker* worker = core.fleet().Find(event.peer);
  const wire::TaskKey& key = event.done.key();
  if (worker != nullptr && worker->Find(key) != nullptr && !IsWellFormed(core, event))
    broken_ = {key.job(), worker->number};
}

// An answer comes: is it a lie, and does it contradict one that is known?
void Checks::Weigh(const Core& core, const TaskDone& event) {
  const wire::TaskKey& key = event.done.key();
  const auto it = jobs_.find(key.job());
  const Job* job = core.FindJob(key.job());
  if (it == jobs_.end() || job == nullptr) return;
  const bool theirs = world_.shell().WasGiven(event.peer, key);
  const Hash claim = ClaimOf(event), known = KnownAnswer(*job, key);
  if (claim != TruthOf(it->second, key)) {
    bool& credible = it->second.lies[claim];
    credible |= theirs && IsWellFormed(core, event);
    world_.Say("  a lie, " + std::string(credible ? "credible" : "not credible"));
  }
  const auto& workers = core.fleet().workers();
  const bool here = std::any_of(workers.begin(), workers.end(),
                                [&event](const auto& entry) { return entry.second.peer == event.peer; });
  if (job->Ended() || !here) return;
  if (known.empty()) {
    const bool past = std::pair(key.stage(), key.round()) < std::pair(job->stage, job->round);
    if (past) world_.Count(kStaleAnswer);
  } else if (known == claim) {
    world_.Count(kSecondAnswer);
  } else if (theirs) {
    alarm_ = claim.empty() ? Alarm::kMay : Alarm::kMust;
  }
}

void Checks::SeeAlarms(const std::vector<Action>& actions) {
  const Report* alarm = nullptr;
  for (const Action& action : actions)
    if (const auto* report = std::get_if<Report>(&action);
        report != nullptr && report->level == Report::kAlarm)
      alarm = report;
  if (alarm != nullptr && alarm_ == Alarm::kNever) Fail("alarm: " + alarm->text);
  if (alarm == nullptr && alarm_ == Alarm::kMust)
    Fail("two answers to one task differ, and no alarm is raised");
  if (alarm != nullptr) world_.Count(kLieFoundOut);
}

// False where there was no such lie. Fails where it was not to be believed.
bool Checks::Believed(const std::string& id, Known& known, const Hash& hash) {
  const auto lie = known.lies.find(hash);
  if (lie == known.lies.end()) return false;
  if (!lie->second)
    Fail(id + " believes a lie that could have been seen through, or from one who was not asked");
  known.deceived = true;
  world_.Count(kLieBelieved);
  return true;
}

void Checks::SeeTruth(const Job& job, Known& known) {
  if (known.deceived || known.kind == ToyKind::kHopeless) return;
  if (job.step) {
    const auto round = known.truth.rounds.find({job.stage, job.round});
    const bool exists = round != known.truth.rounds.end();
    const Hash step = HashOfStep(*job.step);
    if (!exists || step != round->second.step) {
      if (!Believed(job.id, known, step))
        Fail(job.id + " has another step than the undisturbed job in round " + std::to_string(job.round));
      return;
    }
    for (std::size_t i = 0; i < job.partials.size(); ++i) {
      if (job.partials[i].empty() || job.partials[i] == round->second.partials.at(i)) continue;
      if (!Believed(job.id, known, job.partials[i]))
        Fail(job.id + " has another partial of task " + std::to_string(i) + " than the undisturbed job");
      return;
    }
  }
  for (std::size_t i = 0; i < job.results.size(); ++i) {
    if (job.results[i] == known.truth.results.at(i)) continue;
    // A lying plan that ends a stage is believed as the result that it names.
    const bool lied =
        std::any_of(known.lies.begin(), known.lies.end(), [](const auto& lie) { return lie.second; });
    if (!lied) Fail(job.id + " has another result than the undisturbed job");
    known.deceived = true;
    return;
  }
}

}  // namespace cairn::simulation
