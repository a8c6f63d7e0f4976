// Answers to tasks. The first one to a task counts, of whoever was given it; a second one must be the same.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "coordinator/core/core.h"
#include "coordinator/core/round_facts.h"

namespace cairn::coordinator {
namespace {

constexpr double kMostTask_s = 1e9;  // thirty years: whoever says more says no time, and sums stay numbers

// Of a short one with milliseconds.
std::string Seconds(double seconds) {
  return fmt::format("{:.{}f} s", seconds, seconds > 0 && seconds < 1 ? 3 : 1);
}

// "stage 'map', round 3: 12 tasks in 0.8 s, 3.1 s of work: iteration 3"
std::string RoundText(const Job& job, const proto::RoundFacts& round) {
  const std::string stage = "stage '" + job.CurrentStage().name() + "'";
  if (!job.step) return stage + " begins, planned in " + Seconds(round.seconds());
  return stage + ", round " + std::to_string(job.round) + ": " + std::to_string(round.tasks()) +
         (round.tasks() == 1 ? " task in " : " tasks in ") + Seconds(round.seconds()) + ", " +
         Seconds(round.compute_seconds()) + " of work" + (round.note().empty() ? "" : ": " + round.note());
}

Hash BinaryHash(const std::string& binary) {
  const Result<Hash> hash = Hash::FromBinary(binary);
  return hash.ok() ? hash.value() : Hash{};
}

}  // namespace

void Core::On(const TaskDone& event) {
  for (const Hash& blob : event.blobs) ledger_.Offer(blob);  // dropped again unless somebody takes it
  Worker* worker = Heard(event.peer);
  if (worker == nullptr) return;
  const wire::TaskKey& key = event.done.key();
  fleet_.SetHung(*worker, false);
  worker->moved_s = now_s_;
  const double head_s = worker->head_s;
  const bool was_first = !worker->assigned.empty() && SameAttempt(worker->assigned.front().key, key);
  const bool had_it = fleet_.Take(*worker, key, now_s_);
  Job* job = FindById(key.job());
  if (job == nullptr || job->Ended()) return;
  if (!job->WasGiven(key, event.peer)) return RefuseAnswer(*worker, key);
  const bool timed = had_it && was_first && JobOf(key) == job;
  const std::uint64_t cost = timed ? job->tasks.task(key.task()).cost : 0;
  const bool accepted = key.kind() == wire::TaskKey::RUN ? AcceptPartial(*job, event, *worker, had_it)
                                                         : AcceptPlan(*job, event, *worker, had_it);
  if (accepted && timed) job->NoteSeconds(key.kind(), cost, now_s_ - head_s);
  if (accepted && key.kind() == wire::TaskKey::RUN && job->tasks.kind() != wire::TaskKey::RUN)
    job->eta.EndTasks(job->round_since_s, now_s_);
}

// A worker writes nowhere but into the results of its own tasks. (One to a round that is over may be late.)
void Core::RefuseAnswer(const Worker& worker, const wire::TaskKey& key) {
  const Job* job = JobOf(key);
  if (job == nullptr || job->WasGiven(key, worker.peer)) return;
  actions_.push_back(Refused{
      worker.peer,
      {wire::RefusalKind::kTask, "an answer to task " + std::to_string(key.task()) + " of round " +
                                     std::to_string(key.round()) + " of job " + key.job() +
                                     ", which was not given to this worker on " + worker.hello.host()}});
}

// What did not come with an answer is the job's, or the worker could read it anyway: else it would get to
// read any blob whose hash it knows by naming it.
bool Core::MayName(const Job& job, const Worker& worker, const Hash& blob) const {
  if (!ledger_.Held(blob)) return false;
  if (worker.has.contains(blob)) return true;
  return std::ranges::any_of(
      std::array{&job.holds.inputs, &job.holds.results, &job.holds.step, &job.holds.partials},
      [&](const BlobLedger::Hold* hold) { return hold->contains(blob); });
}

bool Core::AcceptPartial(Job& job, const TaskDone& event, Worker& worker, bool had_it) {
  const wire::TaskKey& key = event.done.key();
  if (!job.step || key.stage() != job.stage || key.round() != job.round || key.task() >= job.partials.size())
    return false;
  const Hash partial = BinaryHash(event.done.partial());
  Hash& known = job.partials[key.task()];
  if (!known.empty()) {
    CompareSecond(job, key, known, partial, worker);
    return false;
  }
  const bool came = std::find(event.blobs.begin(), event.blobs.end(), partial) != event.blobs.end();
  std::string wrong;
  if (partial.empty() || !(came || MayName(job, worker, partial))) wrong = "its answer came without its blob";
  if (event.blobs.size() > 1 || (event.blobs.size() == 1 && !came))
    wrong = "its answer came with a blob that it does not name";
  if (!event.wrong.empty()) wrong = event.wrong;
  if (!wrong.empty()) {
    if (had_it) Exclude(job, key, worker, wrong);
    return false;
  }
  Count(job, event.done, worker);
  WithdrawOthers(job, key.task());
  known = partial;
  ledger_.Add(job.holds.partials, partial);
  fleet_.NoteBlob(worker, partial);
  job.tasks.Finish(key.task(), partial);
  if (job.tasks.AllDone()) job.tasks = Round::OfPlan(wire::TaskKey::ADVANCE);
  WantSave(job, false);
  return true;
}

bool Core::AcceptPlan(Job& job, const TaskDone& event, Worker& worker, bool had_it) {
  const wire::TaskKey& key = event.done.key();
  const proto::Step& step = event.done.step();
  const Hash hash = HashOfStep(step);
  if (job.last_plan.kind() == key.kind() && job.last_plan.job() == key.job() &&
      SameTask(job.last_plan, key)) {
    CompareSecond(job, key, job.last_plan_hash, hash, worker);
    return false;
  }
  if (key.kind() != job.tasks.kind() || key.stage() != job.stage || key.round() != job.round ||
      key.task() != 0 || job.AllStagesDone())
    return false;
  std::string wrong = event.done.has_step() ? CheckStep(step) : "its answer has no plan";
  const HashSet came(event.blobs.begin(), event.blobs.end());
  if (wrong.empty())
    for (const Hash& blob : BlobsOfStep(step))
      if (!came.contains(blob) && !MayName(job, worker, blob))
        wrong = "its plan names the blob " + blob.Hex() + ", which is neither the job's nor came with it";
  if (!event.wrong.empty()) wrong = event.wrong;
  if (!wrong.empty()) {
    if (had_it) Exclude(job, key, worker, wrong);
    return false;
  }
  Count(job, event.done, worker);
  WithdrawOthers(job, 0);
  for (const Hash& blob : event.blobs) fleet_.NoteBlob(worker, blob);
  job.last_plan = key;
  job.last_plan_hash = hash;
  job.ForgetGivenBut(key);
  EndRoundFacts(job);
  if (key.kind() == wire::TaskKey::ADVANCE) job.eta.EndRound(now_s_);
  if (step.result().empty())
    BeginRound(job, step);
  else
    EndStage(job, BinaryHash(step.result()));
  actions_.push_back(JobChanged{job.id});
  return true;
}

void Core::CompareSecond(Job& job, const wire::TaskKey& key, const Hash& first, const Hash& second,
                         const Worker& worker) {
  if (first == second) return;
  const std::string what =
      "two answers to task " + std::to_string(key.task()) + " of round " + std::to_string(key.round()) +
      " of stage " + std::to_string(key.stage()) + " of job " + job.id + " differ: " + first.Hex() + " and " +
      second.Hex() + ", the latter by " + std::to_string(worker.hello.pid()) + " on " + worker.hello.host() +
      ". Same task, same bytes is what everything rests on: please report this";
  Say(Report::kAlarm, job, what);
  FailJob(job, what, false);
}

void Core::Count(Job& job, const wire::Done& done, const Worker& worker) {
  if (!job.build) job.build = worker.hello.build();
  ++tally_.tasks_done;
  proto::StageFacts& facts = job.facts.back();
  if (done.seconds() > 0 && done.seconds() <= kMostTask_s)  // what a worker says of itself
    facts.set_open_compute_seconds(facts.open_compute_seconds() + done.seconds());
  facts.set_workers(std::max(facts.workers(), static_cast<std::uint32_t>(fleet_.size())));
  auto& hosts = *facts.mutable_hosts();
  const auto place = std::lower_bound(hosts.begin(), hosts.end(), worker.hello.host());
  if (place != hosts.end() && *place == worker.hello.host()) return;
  const auto index = place - hosts.begin();
  *hosts.Add() = worker.hello.host();
  std::rotate(hosts.begin() + index, hosts.end() - 1, hosts.end());
}

void Core::EndRoundFacts(Job& job) {
  proto::StageFacts& facts = job.facts.back();
  proto::RoundFacts round;
  round.set_note(job.step ? job.step->note() : "start");
  round.set_tasks(job.partials.size());
  round.set_seconds(now_s_ - job.round_since_s);
  tally_.rounds.Add(round.seconds());
  round.set_compute_seconds(facts.open_compute_seconds());
  facts.set_open_compute_seconds(0);
  Say(Report::kInfo, job, RoundText(job, round));
  AddRoundFacts(std::move(round), &facts);
  job.round_since_s = now_s_;
  job.saving.with_partials = false;
  job.task_seconds.clear();
}

void Core::BeginRound(Job& job, const proto::Step& step) {
  job.round = job.step ? job.round + 1 : 0;
  job.step = step;
  job.partials.assign(static_cast<std::size_t>(step.tasks_size()), Hash{});
  ledger_.Replace(job.holds.step, BlobsOfStep(step));
  ledger_.Release(job.holds.partials);
  job.parts.BeginRound();
  job.tasks = step.tasks_size() > 0 ? Round::OfTasks(step) : Round::OfPlan(wire::TaskKey::ADVANCE);
  job.eta.BeginRound(step, job.tasks, now_s_);
  ++job.saving.rounds;
  WantSave(job, false);
}

void Core::EndStage(Job& job, const Hash& result) {
  job.results.push_back(result);
  ledger_.Add(job.holds.results, result);
  job.run_pace = Pace();
  job.eta.BeginStage();
  job.saving.unpublished.push_back({job.stage, result});
  Say(Report::kInfo, job, "stage '" + job.CurrentStage().name() + "' is done");
  ++job.stage;
  job.round = 0;
  job.step.reset();
  job.partials.clear();
  ledger_.Release(job.holds.step);
  ledger_.Release(job.holds.partials);
  BeginAgain(job);
  WantSave(job, true);
}

}  // namespace cairn::coordinator
