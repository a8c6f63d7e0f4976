#include "pipelines/landmark_map/em.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/candidates.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/m_step_task.h"
#include "pipelines/landmark_map/model/work.h"
#include "pipelines/landmark_map/refined_map.h"
#include "pipelines/landmark_map/refinement/contradictions.h"
#include "pipelines/landmark_map/refinement/refine.h"
#include "pipelines/landmark_map/result.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/state/given_map.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/landmark_map/state/speculation.h"

namespace cairn::landmark_map {
namespace {

// The steps of all robots, of a State.
std::vector<RobotSteps> StepsOf(const Inputs& inputs, const MapRules& rules, std::size_t robots) {
  std::vector<RobotSteps> steps;
  for (std::size_t r = 0; r < robots; ++r)
    steps.push_back(
        RobotSteps::In(*inputs.Get("steps/" + std::to_string(r)), rules.layers(), rules.grid.cell_m));
  return steps;
}

Perception PerceptionIn(const Inputs& inputs, const MapRules& rules, const std::string& name = "perception") {
  auto perception = Read<Perception>(*inputs.Get(name));
  perception.Check(rules.layers());
  return perception;
}

// What each robot was looked for in.
std::vector<Perception> PerceptionsIn(const Inputs& inputs, const MapRules& rules, std::size_t robots) {
  std::vector<Perception> of;
  for (std::size_t r = 0; r < robots; ++r) {
    const std::string own = PerceptionFor(r);
    of.push_back(PerceptionIn(inputs, rules, inputs.Has(own) ? own : "perception"));
  }
  return of;
}

// What the next E-step of each robot should cost: what the last one did, or, of a robot that joins (or whose
// start becomes unknown as others do, or who is found anew), what a search of the whole map takes; no more
// than any step takes of one that starts near where it was.
std::vector<double> NextWork(const RoundSum& sum, const Schedule& done, const Schedule& next,
                             const RobotStates& robot_states, bool gauge_free, const EStepModel& model) {
  const std::vector<std::int64_t>& steps = robot_states.step_counts;
  const std::int64_t placed = gauge_free && next.robots > done.robots ? 0 : done.robots;
  std::vector<double> work;
  for (std::size_t r = 0; r < steps.size(); ++r) {
    const int count = StepsInUse(next, steps[r]);
    const bool is_lost =
        static_cast<std::int64_t>(r) >= placed || (done.StartsNearby(r) && !next.StartsNearby(r));
    work.push_back(is_lost ? WorkWhereLost(count, model)
                           : sum.WorkOf(r) * count / StepsInUse(done, steps[r]));
    if (next.StartsNearby(r) && !done.StartsNearby(r))
      work[r] = std::min(work[r], robot_states.sharp[r] * count);
  }
  return work;
}

// What the round's slices leave for guesses, a robot at a time.
class WhatIsLeft {
 public:
  explicit WhatIsLeft(std::size_t robots) : of_(robots) {}
  // In task order.
  void Add(const Blob& partial) {
    if (!partial.Has("log_likelihood")) return;
    const std::int64_t robot = partial.Scalar<std::int32_t>("robot");
    RequireWithin("a partial's robot", robot, 0, std::ssize(of_) - 1);
    of_[static_cast<std::size_t>(robot)].AddEarlier(partial);
  }
  const Guesses& operator[](std::size_t robot) const { return of_[robot]; }

 private:
  std::vector<Guesses> of_;
};

// Which of the next round's slices are guessed, and from what; the overlap doubles where it was too short.
void PlanGuesses(const Options& options, const RoundSum& sum, const WhatIsLeft& left, const Schedule& next,
                 RobotStates* robot_states, std::map<std::string, Blob>* fresh, State* state) {
  for (std::size_t r = 0; options.speculate && r < static_cast<std::size_t>(next.robots); ++r) {
    if (TooShort(sum.guessed(r), sum.confirmed(r))) {
      robot_states->overlap[r] = std::min(2 * robot_states->overlap[r], kMostSteps);
      continue;  // what this round left for guesses lies elsewhere
    }
    const Guesses& guesses = left[r];
    const std::vector<bool> worth = WorthGuessing(guesses, StepsInUse(next, robot_states->step_counts[r]),
                                                  robot_states->overlap[r], next);
    if (std::find(worth.begin(), worth.end(), true) == worth.end()) continue;
    (*fresh)[kGuesses + std::to_string(r)] = guesses.ToBlob();
    GuessSlices(r, worth, state);
  }
}

// Why the map is not refined: empty where it is to be. A given map has a frame of its own.
std::string NoRefinement(const Options& options, const Settings& settings, const Inputs& inputs) {
  if (inputs.Has("map")) return "not tried: the map was given";
  if (!options.refine) return "not tried: refine=false";
  if (!options.revise) return "not tried: revise=false";
  if (options.iterations == 0) return "not tried: iterations=0";
  if (settings.map.exact) return "not tried: model=exact";
  return {};
}

bool AnyAtADistance(const std::vector<RobotSteps>& steps) {
  return std::ranges::any_of(steps, [](const RobotSteps& robot) {
    return std::ranges::any_of(robot.observations, [](const Observation& seen) { return !seen.contact(); });
  });
}

// The last E-step's sum, which no map follows. Throws NoPathError where a task of the round said so.
MStep Summary(Partials& partials, const Settings& settings, WhatIsLeft* left, std::size_t robots) {
  MStep last{RoundSum(settings, robots), {}, {}};
  for (std::size_t i = 0; i < partials.size(); ++i) {
    const BlobPtr partial = partials.Get(i);
    if (partial->Has(kFailure)) throw NoPathError(partial->Text(kFailure));
    last.sum.Add(*partial);
    left->Add(*partial);
  }
  return last;
}

// The last task's. Throws NoPathError where a task of the round said so. `left`: nullptr where the round
// leaves nothing for guesses, and no other partial need be looked at.
MStep MadeMap(Partials& partials, const Settings& settings, WhatIsLeft* left, std::size_t robots) {
  if (partials.size() == 0) throw InputError("a round without an M-step");
  for (std::size_t i = 0; left != nullptr && i + 1 < partials.size(); ++i) left->Add(*partials.Get(i));
  const BlobPtr last = partials.Get(partials.size() - 1);
  if (last->Has(kFailure)) throw NoPathError(last->Text(kFailure));
  return MStep::FromBlob(settings, *last, robots);
}

// The map that all robots but this one made, by a task of this round.
Perception MapWithout(std::size_t robot, const State& state, const Settings& settings, std::size_t robots,
                      Partials& partials) {
  const std::int64_t task = state.scalars().at(TaskWithout(robot)).i();
  RequireWithin(TaskWithout(robot), task, 0, static_cast<std::int64_t>(partials.size()) - 1);
  return MStep::FromBlob(settings, *partials.Get(static_cast<std::size_t>(task)), robots).perception;
}

// Whether names say where a robot is in a map: it gives two of the map's.
bool NamesPlace(const RobotSteps& robot, const Perception& map, const MapRules& rules) {
  if (!rules.partly_named) return false;
  int first = -1;
  for (const Observation& seen : robot.observations) {
    if (seen.type >= rules.types || map.likelihood.layers[static_cast<std::size_t>(seen.type)].box.empty())
      continue;
    if (first >= 0 && seen.type != first) return true;
    first = seen.type;
  }
  return false;
}

// The next round's, in which robots join or are apart: the maps that they are found in, where these are not
// all robots' or not whole.
void TakeMapsOfTheirOwn(const State& state, const Settings& settings, const Schedule& done,
                        const Schedule& next, const MStep& m_step, const std::vector<RobotSteps>& steps,
                        Partials& partials, std::map<std::string, Blob>* fresh) {
  if (!next.is_apart() && next.robots == done.robots) return;
  for (std::size_t r = 1; r < steps.size(); ++r) {
    const Perception found_in =
        next.is_apart() ? MapWithout(r, state, settings, steps.size(), partials) : m_step.perception;
    if (NamesPlace(steps[r], found_in, settings.map))
      (*fresh)[PerceptionFor(r)] = BlobOf(NamesAlone(found_in, settings.map.types));
    else if (next.is_apart())
      (*fresh)[PerceptionFor(r)] = BlobOf(found_in);
  }
}

// Without a map that the round began with, its log-likelihood is of nothing.
std::string Note(const Schedule& done, bool had_map, double log_likelihood, std::size_t landmarks) {
  return fmt::format("iteration {}: {}{} landmarks, {:.0f}% of the data, {} robot{}", done.iteration + 1,
                     had_map ? fmt::format("log-likelihood {:.2f}, ", log_likelihood) : "", landmarks,
                     100.0 * done.prefix, done.robots, done.robots == 1 ? "" : "s");
}

// The last E-step once more, with the refined map.
cairn::Step SummaryUnder(const Options& options, const std::vector<Landmark>& landmarks,
                         const std::vector<Landmark>& before, const Blob& history, const RoundSum& sum,
                         const WhatIsLeft& left, const State& state, const Inputs& inputs) {
  const std::vector<std::string> robots = inputs.Get("log")->Texts("robots");
  const Settings settings = Settings::In(*inputs.Get("settings"), options);
  Schedule schedule = Schedule::Load(state);
  ++schedule.iteration;
  schedule.phase = Phase::kRefinedSummary;
  cairn::Step step;
  // The path is found in the map, to which the map's own uncertainty is nothing; the result's map has it.
  const MapRules& rules = settings.map;
  const LayeredGrid wide = Recentred(sum.counts(), before, landmarks, settings),
                    sharp = Recentred(sum.counts(), before, landmarks, settings, rules.observation_m);
  RequireMemory("the M-step", MStepBytes(sharp, rules), settings.memory_mb);
  std::map<std::string, Blob> fresh{
      {"history", history},
      {"counts", StoredCounts(wide)},
      {"perception", BlobOf(MakePerception(MapFromCounts(sharp, rules), rules))},
      {"path", BlobOf(sum.path())},
      {"landmarks", BlobOf(landmarks)}};
  if (inputs.Has("search")) fresh["search"] = *inputs.Get("search");
  RobotStates robot_states = RobotStates::Load(state, robots.size());
  PlanGuesses(options, sum, left, schedule, &robot_states, &fresh, step.plan.mutable_state());
  PlanRound(options, robots, schedule, robot_states, fresh, &step);
  step.plan.set_note("refined: " + std::to_string(landmarks.size()) + " landmarks by least squares");
  return step;
}

// EM goes on from the map in which a robot was placed anew: each is found in it by itself.
cairn::Step MapOfPlacedAnew(const Options& options, const std::vector<Landmark>& landmarks,
                            const Blob& history, const State& state, const Inputs& inputs) {
  const std::vector<std::string> robots = inputs.Get("log")->Texts("robots");
  const Settings settings = Settings::In(*inputs.Get("settings"), options);
  Schedule schedule = Schedule::Load(state);
  ++schedule.iteration;
  schedule.phase = Phase::kMap;
  schedule.settled = schedule.apart + 1;  // not apart: the map is that of all
  schedule.placed_anew = true;
  const LayeredGrid counts = CountsFromLandmarks(landmarks, settings);
  RequireMemory("the M-step", MStepBytes(counts, settings.map), settings.memory_mb);
  const Perception perception = MakePerception(MapFromCounts(counts, settings.map), settings.map);
  RobotStates robot_states = RobotStates::Load(state, robots.size());
  for (std::size_t r = 0; r < robots.size(); ++r)
    robot_states.work[r] =
        WorkWhereLost(static_cast<int>(robot_states.step_counts[r]), settings.Model(&perception));
  std::map<std::string, Blob> fresh{{"history", history},
                                    {"counts", StoredCounts(counts)},
                                    {"perception", BlobOf(perception)},
                                    {"landmarks", BlobOf(landmarks)}};
  if (inputs.Has("search")) fresh["search"] = *inputs.Get("search");
  cairn::Step step;
  PlanRound(options, robots, schedule, robot_states, fresh, &step);
  step.plan.set_note(
      "a robot's landmarks agree better with the others' in another place: all are found anew");
  return step;
}

}  // namespace

cairn::Step AdvanceEm(const Options& options, const State& state, Partials& partials, const Inputs& inputs) {
  const BlobPtr log = inputs.Get("log");
  const std::vector<std::string> robots = log->Texts("robots");
  const Settings settings = Settings::In(*inputs.Get("settings"), options);
  const Schedule done = Schedule::Load(state, robots.size());
  RobotStates robot_states = RobotStates::Load(state, robots.size());

  WhatIsLeft left(robots.size());
  const MStep m_step =
      done.summarises()
          ? Summary(partials, settings, &left, robots.size())
          : MadeMap(partials, settings, LeavesTables(options, done) ? &left : nullptr, robots.size());
  const RoundSum& sum = m_step.sum;
  if (done.iteration == 0 && inputs.Has("map") && !settings.map.exact) {
    CheckLikelihood(sum.log_likelihood(), PerceptionIn(inputs, settings.map),
                    StepsOf(inputs, settings.map, robots.size()));
  }
  const Blob& before = *inputs.Get("history");
  const auto robots_before = before.Get<std::int64_t>("robots");
  if (!robots_before.empty() && robots_before.back() < done.robots) {
    CheckRobotsFitTheMap(sum, PerceptionsIn(inputs, settings.map, robots.size()),
                         StepsOf(inputs, settings.map, robots.size()), *log);
  }
  const Blob history = Extended(before, done, sum, m_step.landmarks);
  if (done.summarises()) {
    const std::vector<RobotSteps> steps = StepsOf(inputs, settings.map, robots.size());
    const bool at_a_distance = AnyAtADistance(steps);
    std::vector<InTwoPlaces> in_two_places;
    std::string not_refined;
    if (!done.is_refined()) {
      CheckRobotsAgree(sum, history, settings.places, steps[0].observations.size(), *log);
      RequireSize("the map's identities", static_cast<std::size_t>(settings.map.types),
                  log->Texts("landmarks").size());
      in_two_places = LandmarksInTwoPlaces(sum.counts(), settings.map, *log);
      not_refined = NoRefinement(options, settings, inputs);
      if (not_refined.empty() && !at_a_distance && !in_two_places.empty())
        not_refined = "not tried: a landmark stands in two places";
      if (not_refined.empty() && !at_a_distance) {
        const std::vector<Landmark> landmarks = LandmarksIn(*inputs.Get("landmarks"), settings.map);
        const Refinement refined = RefineMap(
            AssociatedPaths(sum, steps, robot_states.odometry, landmarks.size()), settings, landmarks);
        if (refined.refused.empty())
          return SummaryUnder(options, refined.landmarks, landmarks, history, sum, left, state, inputs);
        not_refined = "refused: " + refined.refused;
      }
    }
    RefinedMap map = RefineMapOf(*log, settings, inputs, sum, robot_states.odometry, not_refined,
                                 at_a_distance, in_two_places);
    if (!done.placed_anew) {
      if (const auto landmarks = PlacedAnew(*log, map, settings))
        return MapOfPlacedAnew(options, *landmarks, history, state, inputs);
    }
    return MakeResult(*log, settings, inputs, sum, robot_states.odometry, history, std::move(map));
  }

  if (options.calibrate) {
    for (std::size_t r = 0; r < robots.size(); ++r) {
      double& drift = robot_states.odometry[r].drift_rad_per_m;
      drift = FitDrift(sum.increments()[r], settings.noise, drift);
    }
    FitWidths(sum.increments(), settings.noise, &robot_states.odometry);
  }
  const Schedule next =
      done.Next(options, static_cast<std::int64_t>(robots.size()), sum.log_likelihood(), sum.counts().Sum());
  robot_states.work =
      NextWork(sum, done, next, robot_states, settings.gauge_free, settings.Model(&m_step.perception));
  robot_states.landmarks = std::ssize(m_step.landmarks);
  cairn::Step step;
  std::map<std::string, Blob> fresh{{"history", history},
                                    {"counts", StoredCounts(sum.counts())},
                                    {"perception", BlobOf(m_step.perception)},
                                    {"path", BlobOf(sum.path())},
                                    {"landmarks", BlobOf(m_step.landmarks)}};
  if (inputs.Has("search")) fresh["search"] = *inputs.Get("search");
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const std::vector<StartBox> start = sum.StartOf(r);
    if (next.StartsNearby(r) && !start.empty()) fresh[StartNear(r)] = BlobOf(start);
  }
  TakeMapsOfTheirOwn(state, settings, done, next, m_step, StepsOf(inputs, settings.map, robots.size()),
                     partials, &fresh);
  PlanGuesses(options, sum, left, next, &robot_states, &fresh, step.plan.mutable_state());
  PlanRound(options, robots, next, robot_states, fresh, &step);
  step.plan.set_note(Note(done, inputs.Has("perception"), sum.log_likelihood(), m_step.landmarks.size()));
  return step;
}

}  // namespace cairn::landmark_map
