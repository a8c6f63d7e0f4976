#include "coordinator/core/job.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "coordinator/core/eta.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kTimesKept = 101;  // of tasks, for their median

}  // namespace

wire::TaskKey Job::Key(std::uint32_t task, std::uint32_t attempt) const {
  wire::TaskKey key;
  key.set_job(id);
  key.set_stage(stage);
  key.set_round(round);
  key.set_task(task);
  key.set_kind(tasks.kind());
  key.set_attempt(attempt);
  return key;
}

namespace {

GivenAttempt Given(const wire::TaskKey& key, const std::string& peer) {
  return {key.stage(), key.round(), key.kind(), key.task(), key.attempt(), peer};
}

}  // namespace

void Job::NoteGiven(const wire::TaskKey& key, const std::string& peer) { given.insert(Given(key, peer)); }

bool Job::WasGiven(const wire::TaskKey& key, const std::string& peer) const {
  return given.contains(Given(key, peer));
}

void Job::ForgetGivenBut(const wire::TaskKey& plan) {
  std::erase_if(given, [&plan](const GivenAttempt& attempt) {
    return attempt.kind != plan.kind() || attempt.stage != plan.stage() || attempt.round != plan.round();
  });
}

bool Job::IsUnderWay(const wire::TaskKey& key) const {
  return !Ended() && key.stage() == stage && key.round() == round && key.kind() == tasks.kind() &&
         key.task() < tasks.size();
}

std::string Job::TaskName(std::uint32_t task) const {
  const std::string where = "stage '" + CurrentStage().name() + "'";
  if (tasks.kind() == wire::TaskKey::START) return "the start of " + where;
  const std::string round_name = "round " + std::to_string(round) + " of " + where;
  if (tasks.kind() == wire::TaskKey::ADVANCE) return "the reduction of " + round_name;
  const std::string& kind = step->tasks(static_cast<int>(task)).kind();
  return "task " + std::to_string(task) + (kind.empty() ? "" : " (" + kind + ")") + " of " + round_name;
}

std::string Whereabouts(const Job& job) {
  if (job.AllStagesDone() || job.tasks.size() == 0) return "";
  if (job.tasks.kind() != wire::TaskKey::RUN) return ", at " + job.TaskName(0);
  return ", at round " + std::to_string(job.round) + " of stage '" + job.CurrentStage().name() +
         "', which has " + std::to_string(job.tasks.done_count()) + " of its " +
         std::to_string(job.tasks.size()) + " tasks done";
}

std::uint64_t PartPlaces::WorkerOf(const Hash& part) const {
  for (const auto* places : {&now, &before})
    if (const auto it = places->find(part); it != places->end()) return it->second;
  return 0;
}

std::optional<Hash> Job::SoFar() const {
  if (!step || Final() || AllStagesDone() || step->state().so_far().empty()) return std::nullopt;
  return Hash::FromBinary(step->state().so_far()).value();
}

void Job::SetSpec(const proto::Job& job) {
  spec = job;
  hash = HashOfJob(job);
}

Standing Job::Stands() const {
  return {state, reason, input_error, held, spec.priority(), failures, ended_served_s};
}

double Job::Seconds(double now_s) const {
  return seconds_before + (Running() ? now_s - running_since_s : 0.0);
}

double Job::MedianTaskSeconds() const {
  if (task_seconds.size() < 3) return 0;
  std::vector<double> sorted(task_seconds.begin(), task_seconds.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

void Job::NoteSeconds(wire::TaskKey::Kind kind, std::uint64_t cost, double seconds) {
  Pace& pace = kind == wire::TaskKey::RUN ? run_pace : plan_pace;
  pace.seconds += seconds;
  pace.cost += static_cast<double>(cost);
  if (kind != wire::TaskKey::RUN) return;
  eta.NoteTask(static_cast<double>(cost), seconds);
  task_seconds.push_back(seconds);
  if (task_seconds.size() > kTimesKept) task_seconds.pop_front();
}

double Job::ExpectedSeconds(std::uint32_t task) const {
  const auto cost = static_cast<double>(tasks.task(task).cost);
  if (tasks.kind() != wire::TaskKey::RUN) return plan_pace.Expect(1);
  return run_pace.Expect(cost);
}

double Job::ExpectedSeconds(const Round::Share& share) const {
  const bool plan = tasks.kind() != wire::TaskKey::RUN;
  const Pace& pace = plan ? plan_pace : run_pace;
  // Sums of large costs from which others were taken need not end at 0.
  return share.tasks == 0 ? 0 : pace.cost > 0 ? std::max(0.0, pace.Expect(share.cost)) : share.tasks;
}

bool IsPlainName(const std::string& name) {
  return !name.empty() && name.size() <= 100 && name[0] != '.' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
         });
}

bool IsFileOfARun(const std::string& name) {
  return name.ends_with(".h5") || name == "map.png" || name == "picture.png" || name == "report.html" ||
         name == "job.yaml";
}

std::string CheckJob(const proto::Job& job) {
  if (job.stages_size() == 0) return "the job has no stages";
  if (job.priority() < kLowestPriority || job.priority() > kHighestPriority)
    return "the priority " + std::to_string(job.priority()) + " is not one of -10 to 10";
  if (!(job.task_time_s() >= 0 && std::isfinite(job.task_time_s())))
    return "task_time_s must be a time in seconds, or 0";
  if (job.task_memory_mb() > kMostTaskMemory_mb)
    return "task_memory_mb must be at most " + std::to_string(kMostTaskMemory_mb);
  std::set<std::string> known;
  for (const auto& [name, hash] : job.input_blobs()) {
    if (hash.size() != sizeof(Hash::bytes)) return "the input '" + name + "' has no content hash";
    known.insert(name);
  }
  for (const proto::Stage& stage : job.stages()) {
    if (!IsPlainName(stage.name()))
      return "'" + stage.name() +
             "' cannot be a stage's name: letters, digits, '_', '-' and '.' can, up to 100, " +
             "and no '.' first";
    if (IsFileOfARun(stage.name()))
      return "stage '" + stage.name() + "' has the name of a file that a run writes";
    for (const auto& [name, source] : stage.inputs())
      if (!known.contains(source))
        return "stage '" + stage.name() + "' reads '" + source + "' as its " + name +
               ", but there is no input or earlier stage of that name";
    if (!known.insert(stage.name()).second) return "two stages or inputs are called '" + stage.name() + "'";
  }
  return "";
}

Hash HashOfJob(const proto::Job& job) {
  proto::Job canonical = job;
  canonical.clear_inputs();
  canonical.clear_priority();
  canonical.clear_task_time_s();
  canonical.clear_task_memory_mb();
  return HashOfMessage(canonical);
}

std::map<std::string, Hash> StageInputs(const Job& job) {
  std::map<std::string, Hash> sources;
  for (const auto& [name, hash] : job.spec.input_blobs()) sources[name] = Hash::FromBinary(hash).value();
  for (std::size_t i = 0; i < job.results.size(); ++i)
    sources[job.spec.stages(static_cast<int>(i)).name()] = job.results[i];
  std::map<std::string, Hash> inputs;
  for (const auto& [name, source] : job.CurrentStage().inputs()) inputs[name] = sources.at(source);
  return inputs;
}

wire::Assign MakeAssign(const Job& job, std::uint32_t task, std::uint32_t attempt) {
  wire::Assign assign;
  *assign.mutable_key() = job.Key(task, attempt);
  *assign.mutable_stage() = job.CurrentStage();
  assign.set_seed(job.spec.seed());
  assign.set_memory_mb(job.spec.task_memory_mb());
  if (job.tasks.kind() == wire::TaskKey::RUN) {
    *assign.mutable_task() = job.step->tasks(static_cast<int>(task));
    for (proto::InputRef& input : *assign.mutable_task()->mutable_inputs())
      if (input.has_task()) input.set_blob(job.partials.at(input.task()).Binary());
    return assign;
  }
  for (const auto& [name, hash] : StageInputs(job)) (*assign.mutable_inputs())[name] = hash.Binary();
  if (job.tasks.kind() == wire::TaskKey::ADVANCE) {
    *assign.mutable_state() = job.step->state();
    for (const Hash& partial : job.partials) assign.add_partials(partial.Binary());
  }
  return assign;
}

std::vector<Hash> TaskInputs(const Job& job, std::uint32_t task) {
  std::vector<Hash> hashes;
  if (job.tasks.kind() == wire::TaskKey::RUN) {
    for (const proto::InputRef& input : job.step->tasks(static_cast<int>(task)).inputs())
      hashes.push_back(input.has_task() ? job.partials.at(input.task())
                                        : Hash::FromBinary(input.blob()).value());
    return hashes;
  }
  for (const auto& [name, hash] : StageInputs(job)) hashes.push_back(hash);
  if (job.tasks.kind() != wire::TaskKey::ADVANCE) return hashes;
  hashes.insert(hashes.end(), job.partials.begin(), job.partials.end());
  for (const auto& [name, hash] : job.step->state().blobs()) hashes.push_back(Hash::FromBinary(hash).value());
  return hashes;
}

const char* StateName(const Job& job) {
  switch (job.state) {
    case proto::JOB_PAUSED:
      return "paused";
    case proto::JOB_DONE:
      return "done";
    case proto::JOB_FAILED:
      return "failed";
    case proto::JOB_CANCELLED:
      return "cancelled";
    default:
      return job.build.has_value() ? "running" : "queued";
  }
}

wire::JobInfo MakeInfo(const Job& job, double now_s) {
  wire::JobInfo info;
  info.set_id(job.id);
  info.set_name(job.spec.name());
  info.set_owner(job.owner);
  info.set_state(StateName(job));
  info.set_reason(job.reason);
  info.set_stage(job.AllStagesDone() && job.stage > 0 ? job.stage - 1
                                                      : job.stage);  // the last one, when done
  info.set_stages(job.StageCount());
  if (info.stage() < info.stages())
    info.set_stage_name(job.spec.stages(static_cast<int>(info.stage())).name());
  if (job.Running()) {
    const TimeLeft left = job.eta.Shown(now_s);
    info.set_eta_s(left.expected_s);
    info.set_eta_least_s(left.least_s);
    info.set_eta_most_s(left.most_s);
  }
  info.set_round(job.round);
  info.set_input_error(job.input_error);
  info.set_priority(job.spec.priority());
  info.set_task_time_s(job.spec.task_time_s());
  info.set_task_memory_mb(job.spec.task_memory_mb());
  info.set_seconds(job.Seconds(now_s));
  info.mutable_failures()->Assign(job.failures.begin(), job.failures.end());
  for (const proto::StageFacts& facts : job.facts) {
    info.set_retries(info.retries() + facts.retries());
    info.set_lost(info.lost() + facts.lost());
  }
  if (!job.step) return info;
  info.set_tasks(static_cast<std::uint32_t>(job.step->tasks_size()));
  info.set_tasks_done(job.tasks.kind() == wire::TaskKey::RUN ? job.tasks.done_count() : info.tasks());
  info.set_note(job.step->note());
  if (const auto so_far = job.SoFar()) info.set_so_far(so_far->Binary());
  double later = 0;
  for (const proto::Phase& phase : job.step->later()) later += phase.rounds();
  info.set_rounds_left(1 + static_cast<std::uint32_t>(std::lround(std::min(later, 1e9))));
  return info;
}

wire::Demand DemandOf(const Job& job) {
  wire::Demand demand;
  demand.set_tasks(job.step ? static_cast<std::uint32_t>(std::max(1, job.step->tasks_size())) : 1);
  demand.set_work_s(job.step ? job.eta.Work_s(*job.step, job.tasks) : job.ExpectedSeconds(0));
  return demand;
}

proto::Checkpoint MakeCheckpoint(const Job& job, double now_s, bool with_partials) {
  proto::Checkpoint checkpoint;
  checkpoint.set_job_id(job.id);
  checkpoint.set_order(job.order);
  checkpoint.set_owner(job.owner);
  *checkpoint.mutable_job() = job.spec;
  checkpoint.set_state(job.AllStagesDone() && job.Running() ? proto::JOB_DONE : job.state);
  checkpoint.set_reason(job.reason);
  checkpoint.set_input_error(job.input_error);
  checkpoint.set_held(job.held);
  checkpoint.set_stage(job.stage);
  checkpoint.set_round(job.round);
  const bool final = checkpoint.state() == proto::JOB_DONE || checkpoint.state() == proto::JOB_CANCELLED;
  if (job.step && !final) *checkpoint.mutable_step() = *job.step;
  for (const Hash& result : job.results) checkpoint.add_results(result.Binary());
  if (job.build) *checkpoint.mutable_build() = *job.build;
  for (const proto::StageFacts& facts : job.facts) *checkpoint.add_facts() = facts;
  checkpoint.set_seconds(job.Seconds(now_s));
  if (final) return checkpoint;  // published results are files of their own
  std::vector<Hash> blobs(job.holds.inputs.begin(), job.holds.inputs.end());
  blobs.insert(blobs.end(), job.holds.results.begin(), job.holds.results.end());
  blobs.insert(blobs.end(), job.holds.step.begin(), job.holds.step.end());
  if (with_partials) {
    blobs.insert(blobs.end(), job.holds.partials.begin(), job.holds.partials.end());
    for (const Hash& partial : job.partials)
      checkpoint.add_partials(partial.empty() ? std::string() : partial.Binary());
  }
  std::sort(blobs.begin(), blobs.end());
  blobs.erase(std::unique(blobs.begin(), blobs.end()), blobs.end());
  for (const Hash& blob : blobs) checkpoint.add_blobs(blob.Binary());
  return checkpoint;
}

}  // namespace cairn::coordinator
