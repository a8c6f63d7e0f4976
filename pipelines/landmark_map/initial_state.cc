#include "pipelines/landmark_map/initial_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pipelines/landmark_map/model/work.h"
#include "pipelines/landmark_map/outlook.h"
#include "pipelines/landmark_map/result.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/landmark_map/state/speculation.h"

namespace cairn::landmark_map {
namespace {

// Which layers of the map a robot's observations may be of: any class may seem another, what has no name may
// be what others name, and the other way round.
std::vector<bool> TypesSeen(const RobotSteps& robot, const MapRules& rules) {
  std::vector<bool> seen(static_cast<std::size_t>(rules.layers()), false);
  for (const Observation& o : robot.observations) seen[static_cast<std::size_t>(o.type)] = true;
  const auto classes = seen.begin() + rules.types;
  const bool any = rules.partly_named && !robot.observations.empty();
  if (any || std::find(classes, seen.end(), true) != seen.end()) std::fill(classes, seen.end(), true);
  if (any && rules.named_later && rules.classes.count == 1) seen.assign(seen.size(), true);
  return seen;
}

// Of a robot that knows of where it is by one landmark alone nothing tells how it lies turned about that.
void CheckSeenTwo(const kinds::Log& log, std::size_t robot) {
  std::set<std::int32_t> by_others, common;
  for (std::size_t r = 0; r < log.robot.size(); ++r)
    if (r != robot)
      for (const std::int32_t landmark : log.robot[r].observations.landmark.OrNone())
        by_others.insert(landmark);
  if (by_others.contains(-1)) return;  // which they are, is found out
  for (const std::int32_t landmark : log.robot[robot].observations.landmark.OrNone()) {
    if (landmark < 0) return;  // which it is, is found out
    if (by_others.contains(landmark)) common.insert(landmark);
  }
  if (common.size() != 1) return;
  throw InputError(
      fmt::format("robot '{}' has seen only one landmark that another robot saw too, '{}': about that it may "
                  "be turned by any angle, so it cannot be placed; at least two must have the same names for "
                  "two robots. Or map each robot by itself",
                  log.robots[robot], log.landmarks[static_cast<std::size_t>(*common.begin())]));
}

// The names that some of these robots give and `robot` gives, too.
std::vector<bool> NamesInCommon(const kinds::Log& log, std::size_t robot, std::size_t begin, std::size_t end,
                                const MapRules& rules) {
  std::vector<bool> others(static_cast<std::size_t>(rules.layers()), false), common = others;
  for (std::size_t r = begin; r < end; ++r) {
    if (r == robot) continue;
    for (const std::int32_t name : log.robot[r].observations.landmark.OrNone())
      if (name >= 0) others[static_cast<std::size_t>(name)] = true;
  }
  for (const std::int32_t name : log.robot[robot].observations.landmark.OrNone())
    if (name >= 0) common[static_cast<std::size_t>(name)] = others[static_cast<std::size_t>(name)];
  return common;
}

// Whether finding a robot by the first of these names, of all places from which its way may lead there, moves
// more cells than a search of the whole map.
bool IsFarBefore(const std::vector<bool>& names, const RobotSteps& steps, const Settings& settings) {
  int step = 0;
  const auto gives = [&](int at) {
    return std::any_of(steps.observations.begin() + steps.first_observation[at],
                       steps.observations.begin() + steps.first_observation[at + 1],
                       [&](const Observation& seen) { return names[static_cast<std::size_t>(seen.type)]; });
  };
  while (step + 1 < steps.size() && !gives(step)) ++step;
  const double edge = 2.0 * MotionMargin(settings.Model(nullptr), steps, step) + 1.0;
  return (step + 1) * edge * edge > kStepsLost * settings.places;
}

// The steps of a robot that the first one's map places. Where names do (em.cc), and what it saw before them
// is far away, they begin with the first name; the rest is added in the end (seen_before.h, all_rows.h).
RobotSteps StepsOfLater(const kinds::Log& log, std::size_t robot, const std::vector<bool>& shared,
                        const Settings& settings) {
  constexpr std::ptrdiff_t kEnough = 2;
  RobotSteps steps = MakeSteps(log.robot[robot], log.robots[robot], settings.steps, &shared);
  if (!settings.map.partly_named) return steps;
  std::vector<bool> names = NamesInCommon(log, robot, 0, 1, settings.map);
  if (std::ranges::count(names, true) < kEnough)
    names = NamesInCommon(log, robot, 0, log.robot.size(), settings.map);
  if (std::ranges::count(names, true) < kEnough || !IsFarBefore(names, steps, settings)) return steps;
  return MakeSteps(log.robot[robot], log.robots[robot], settings.steps, &names);
}

std::vector<bool> TypesIn(const LayeredGrid& map) {
  std::vector<bool> types;
  for (const Layer& layer : map.layers) types.push_back(!layer.box.empty());
  return types;
}

}  // namespace

bool StartsAnywhere(const Options& options, std::size_t robot) {
  return robot > 0 || options.start == "anywhere";
}

InitialState MakeInitialState(const Options& options, const Inputs& inputs) {
  const Blob& log = *inputs.Get("log");
  InitialState initial{Resolve(options, log), {}, {}, {}};
  initial.schedule.prefix = initial.settings.growth_start;
  initial.schedule.growth = initial.settings.growth_factor;
  initial.schedule.apart = inputs.Has("map") ? 0 : IterationsApart(initial.settings);
  if (options.iterations == 0) initial.schedule.phase = Phase::kSummary;
  if (options.iterations == 0) initial.settings.starts = 1;  // nothing to choose from
  const std::size_t robots = log.Texts("robots").size();
  if (!inputs.Has("map")) {
    if (options.start == "anywhere") throw InputError("start=anywhere needs the input 'map'");
    if (options.iterations == 0 && robots > 1)
      throw InputError("iterations=0 needs the input 'map' where there are several robots");
    return initial;
  }
  if (options.starts > 1) throw InputError("with the input 'map' EM starts from it alone: take starts=1");
  initial.settings.starts = 1;
  initial.settings.gauge_free = false;  // the frame is the given map's
  initial.schedule.prefix = 1.0;
  initial.schedule.robots = static_cast<std::int64_t>(robots);
  initial.given = ReadGivenMap(*inputs.Get("map"), log, initial.settings);
  // [TBF98] section 4: the E-step is localization in a map.
  initial.perception = MakePerception(initial.given->map, initial.settings.map);
  return initial;
}

RobotStates MakeAllSteps(const Blob& blob, const Options& options, const InitialState& initial,
                         cairn::Step* step, std::vector<RobotSteps>* all) {
  const auto log = Read<kinds::Log>(blob);
  const std::vector<std::string>& robots = log.robots;
  const Settings& settings = initial.settings;
  std::vector<bool> shared;
  if (initial.given) shared = TypesIn(initial.given->map);
  RobotStates robot_states;
  robot_states.blobs["settings"] = step->Share(settings.ToBlob());
  robot_states.odometry.assign(robots.size(), OdometryFit::Of(settings.noise));
  robot_states.overlap.assign(robots.size(), kOverlap);
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const bool anywhere = StartsAnywhere(options, r);
    const RobotSteps steps = r > 0 && !initial.given ? StepsOfLater(log, r, shared, settings)
                                                     : MakeSteps(log.robot[r], robots[r], settings.steps,
                                                                 anywhere ? &shared : nullptr);
    if (shared.empty()) shared = TypesSeen(steps, settings.map);
    if (!initial.given && r > 0) CheckSeenTwo(log, r);
    if (initial.given && !anywhere) CheckReach(initial.given->map, steps, settings);
    robot_states.step_counts.push_back(steps.size());
    const int count = StepsInUse(initial.schedule, steps.size());
    robot_states.work.push_back(
        anywhere && initial.perception
            ? WorkWhereLost(count, settings.Model(&*initial.perception))
            : WorkOf(ReckonOpenLoop(steps, settings.Model(nullptr), count).cells, count));
    robot_states.sharp.push_back(WorkOfStep(steps, settings.Model(nullptr)));
    robot_states.refined_rows.push_back(RefinedRows(log.robot[r].observations));
    robot_states.blobs["steps/" + std::to_string(r)] = step->Share(BlobOf(steps));
    all->push_back(steps);
  }
  return robot_states;
}

std::map<std::string, Blob> FirstBlobs(const InitialState& initial) {
  std::map<std::string, Blob> blobs{{"history", EmptyHistory()},
                                    {"counts", StoredCounts(NoCounts(initial.settings.map))}};
  if (initial.given) {
    blobs["landmarks"] = BlobOf(initial.given->landmarks);
    blobs["perception"] = BlobOf(*initial.perception);
  } else if (initial.schedule.summarises()) {
    blobs["landmarks"] = BlobOf(std::vector<Landmark>{});
  }
  return blobs;
}

}  // namespace cairn::landmark_map
