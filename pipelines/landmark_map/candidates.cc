#include "pipelines/landmark_map/candidates.h"

#include <algorithm>
#include <utility>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/task_builder.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/model/work.h"
#include "pipelines/landmark_map/outlook.h"
#include "pipelines/landmark_map/result.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/state/partial.h"

namespace cairn::landmark_map {
namespace {

constexpr const char* kStartDrift = "start_drift";
constexpr const char* kStartPrefix = "start_prefix";
constexpr const char* kRefitOf = "refit_of";
constexpr const char* kWentOn = "search_went_on";
constexpr double kMostDrift = 1e6, kLeastPrefix = 1e-9;
constexpr const char* kAwaits = "awaits_associations";
constexpr const char* kAssociations = "associations";
constexpr const char* kOfSearch[] = {kStartDrift, kStartPrefix, kRefitOf, kWentOn, kWave, kBeyond, kFiner};

void StoreStart(const StartingPoint& start, int refit_of, State* state) {
  auto& scalars = *state->mutable_scalars();
  scalars[kStartDrift].set_d(start.drift_rad_per_m);
  scalars[kStartPrefix].set_d(start.prefix);
  scalars[kRefitOf].set_i(refit_of);
}

}  // namespace

void BeginFrom(const StartingPoint& start, const Options& options, const std::vector<std::string>& robots,
               const Settings& settings, const RobotSteps& first_robot, cairn::Step* step) {
  State* state = step->plan.mutable_state();
  RobotStates robot_states = RobotStates::Load(*state, robots.size());
  robot_states.odometry[0] = OdometryFit::Of(settings.noise);
  robot_states.odometry[0].drift_rad_per_m = start.drift_rad_per_m;
  Schedule schedule;
  schedule.prefix = start.prefix;
  schedule.growth = settings.growth_factor;
  schedule.apart = IterationsApart(settings);
  const int count = StepsInUse(schedule, first_robot.size());
  robot_states.work[0] = WorkOf(ReckonOpenLoop(first_robot, settings.Model(nullptr), count).cells, count);
  state->Clear();
  StoreStart(start, -1, state);
  PlanRound(options, robots, schedule, robot_states,
            {{"history", EmptyHistory()}, {"counts", StoredCounts(NoCounts(settings.map))}}, step);
}

void KeepStart(const State& before, State* after) {
  for (const char* name : kOfSearch) {
    const auto kept = before.scalars().find(name);
    if (kept != before.scalars().end()) (*after->mutable_scalars())[name] = kept->second;
  }
}

void PlanAssociations(const Options& options, const std::vector<std::string>& robots, cairn::Step* step) {
  State& state = *step->plan.mutable_state();
  (*state.mutable_scalars())[kAwaits].set_b(true);
  const State after = state;
  Schedule schedule = Schedule::Load(state);
  schedule.robots = 1;
  schedule.phase = Phase::kSummary;
  schedule.Store(&state);
  step->plan.clear_tasks();
  PlanTasks(options, robots, &step->plan);
  state = after;
}

bool AwaitsAssociations(const State& state) { return state.scalars().contains(kAwaits); }

void KeepAssociations(const Options& options, Partials& partials, const Inputs& inputs, cairn::Step* step) {
  std::vector<Blob> summaries;
  for (std::size_t i = 0; i < partials.size(); ++i) {
    const BlobPtr partial = partials.Get(i);
    if (partial->Has(kFailure)) throw NoPathError(partial->Text(kFailure));
    if (partial->Has("association/landmark")) summaries.push_back(SummaryOf(*partial));
  }
  std::ranges::sort(summaries, {}, [](const Blob& b) { return b.Scalar<std::int32_t>("first"); });
  const MapRules rules = Settings::In(*inputs.Get("settings"), options).map;
  CheckSummaries(summaries, RobotSteps::In(*inputs.Get("steps/0"), rules.layers(), rules.grid.cell_m),
                 LandmarksIn(*inputs.Get("landmarks"), rules).size());
  Blob associations;
  associations.PutVector("landmark", AssociatedIn(summaries).landmark);
  State& state = *step->plan.mutable_state();
  state.mutable_scalars()->erase(kAwaits);
  (*state.mutable_blobs())[kAssociations] = step->Share(std::move(associations));
}

void DropAssociations(State* state) { state->mutable_blobs()->erase(kAssociations); }

CandidateRounds::CandidateRounds(const Options& options, std::vector<cairn::Step> steps, const Inputs& inputs)
    : options_(options),
      steps_(std::move(steps)),
      inputs_(inputs),
      robots_(inputs.Get("log")->Texts("robots")),
      settings_(Settings::In(*BlobOf(0, "settings"), options)) {
  std::ptrdiff_t observations = -1;
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const State& state = steps_[k].plan.state();
    const auto& scalars = state.scalars();
    Candidate& candidate = candidates_.emplace_back();
    candidate.start = {scalars.at(kStartDrift).d(), scalars.at(kStartPrefix).d()};
    RequireWithin(kStartDrift, candidate.start.drift_rad_per_m, -kMostDrift, kMostDrift);
    RequireWithin(kStartPrefix, candidate.start.prefix, kLeastPrefix, 1.0);
    candidate.refit_of = static_cast<int>(scalars.at(kRefitOf).i());
    if (scalars.contains(kFailure)) {
      candidate.failure = scalars.at(kFailure).s();
      continue;
    }
    candidate.drift_rad_per_m = RobotStates::Load(state, robots_.size()).odometry[0].drift_rad_per_m;
    candidate.log_likelihood = scalars.at("log_likelihood").d();
    candidate.landmarks = LandmarksIn(*BlobOf(k, "landmarks"), settings_.map);
    const auto of = BlobOf(k, kAssociations)->Get<std::int32_t>("landmark");
    candidate.associations.assign(of.begin(), of.end());
    if (observations < 0) observations = std::ssize(of);
    RequireSize("the associations of a candidate", of.size(), static_cast<std::size_t>(observations));
  }
}

bool CandidateRounds::WentOn(std::size_t candidate) const {
  return steps_[candidate].plan.state().scalars().contains(kWentOn);
}

int CandidateRounds::waves() const {
  std::int64_t waves = 0;
  for (const cairn::Step& step : steps_) {
    const auto wave = step.plan.state().scalars().find(kWave);
    if (wave != step.plan.state().scalars().end()) waves = std::max(waves, wave->second.i());
  }
  RequireWithin(kWave, waves, 0, kMostTasks);
  return static_cast<int>(waves);
}

double CandidateRounds::Seconds() const {
  double us = 0.0;
  for (const cairn::Step& step : steps_) us += CostSoFar(step.plan.state());
  return 1e-6 * us;
}

bool CandidateRounds::WentOnFrom(int candidate) const {
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    if (WentOn(k) &&
        SameMap(candidates_[k], candidates_[static_cast<std::size_t>(candidate)], settings_.alike))
      return true;
  }
  return false;
}

double CandidateRounds::MeanIncrementM() const {
  const RobotSteps steps =
      RobotSteps::In(*BlobOf(0, "steps/0"), settings_.map.layers(), settings_.map.grid.cell_m);
  return steps.DistanceTravelled().back() / static_cast<double>(steps.observations.size());
}

void CandidateRounds::GoOnFrom(int best, int beyond, const std::vector<Proposal>& proposals) {
  (*steps_[static_cast<std::size_t>(best)].plan.mutable_state()->mutable_scalars())[kWentOn].set_b(true);
  const RobotSteps first_robot =
      RobotSteps::In(*BlobOf(0, "steps/0"), settings_.map.layers(), settings_.map.grid.cell_m);
  const int wave = waves() + 1;
  std::vector<cairn::Step> added;
  for (const Proposal& proposal : proposals) {
    if (proposal.without) {
      added.push_back(Refit(best, *proposal.without));
    } else {
      cairn::Step& step = added.emplace_back();
      *step.plan.mutable_state() = steps_[0].plan.state();
      BeginFrom(proposal.start, options_, robots_, settings_, first_robot, &step);
    }
  }
  for (cairn::Step& step : added) {
    (*step.plan.mutable_state()->mutable_scalars())[kWave].set_i(wave);
    (*step.plan.mutable_state()->mutable_scalars())[kBeyond].set_i(beyond);
    CountCost({}, &step);
    steps_.push_back(std::move(step));
  }
}

// A blob that a candidate's state names: new, or one that the round had.
BlobPtr CandidateRounds::BlobOf(std::size_t candidate, const std::string& name) const {
  const std::string& hash = steps_[candidate].plan.state().blobs().at(name);
  for (const BlobPtr& blob : steps_[candidate].blobs) {
    if (blob->ContentHash().Binary() == hash) return blob;
  }
  return inputs_.Get("start/" + std::to_string(candidate) + "/" + name);
}

cairn::Step CandidateRounds::Refit(int parent, std::size_t without) const {
  const auto k = static_cast<std::size_t>(parent);
  const State& before = steps_[k].plan.state();
  LayeredGrid counts = LayeredGrid::Load("counts/", *BlobOf(k, "counts"));
  CheckCounts(counts, settings_.map);
  RequireMemory("the M-step", MStepBytes(counts, settings_.map), settings_.memory_mb);
  LeaveOut(candidates_[k].landmarks[without], settings_.map, &counts);
  const Perception perception = MakePerception(MapFromCounts(counts, settings_.map), settings_.map);
  Schedule schedule = Schedule::Load(before);
  schedule.robots = 1;
  schedule.settled = 0;
  schedule.phase = Phase::kMap;
  cairn::Step step;
  *step.plan.mutable_state() = before;
  step.plan.mutable_state()->mutable_scalars()->erase(kWentOn);
  GuessNothing(step.plan.mutable_state());
  DropAssociations(step.plan.mutable_state());
  StoreStart(candidates_[k].start, parent, step.plan.mutable_state());
  PlanRound(options_, robots_, schedule, RobotStates::Load(before, robots_.size()),
            {{"counts", StoredCounts(counts)}, {"perception", cairn::BlobOf(perception)}}, &step);
  return step;
}

}  // namespace cairn::landmark_map
