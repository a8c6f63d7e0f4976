#include "pipelines/landmark_map/beginning.h"

#include <algorithm>

#include "pipelines/landmark_map/model/work.h"
#include "pipelines/landmark_map/result.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/landmark_map/state/speculation.h"

namespace cairn::landmark_map {
namespace {

std::string RobotPath(std::size_t robot) { return "robot/" + std::to_string(robot) + "/"; }

// Which layers of the map a robot's observations may be of: any kind may seem another.
std::vector<bool> TypesSeen(const RobotSteps& robot, const MapRules& rules) {
  std::vector<bool> seen(static_cast<std::size_t>(rules.layers()), false);
  for (const Observation& o : robot.observations) seen[static_cast<std::size_t>(o.type)] = true;
  const auto kinds = seen.begin() + rules.types;
  if (std::find(kinds, seen.end(), true) != seen.end()) std::fill(kinds, seen.end(), true);
  return seen;
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

Beginning BeginningOf(const Options& options, const Inputs& inputs) {
  const Blob& log = *inputs.Get("log");
  Beginning beginning{Resolve(options, log), {}, {}, {}};
  beginning.schedule.prefix = beginning.settings.growth_start;
  beginning.schedule.growth = beginning.settings.growth_factor;
  beginning.schedule.summarise = options.iterations == 0;
  if (options.iterations == 0) beginning.settings.starts = 1;  // nothing to choose from
  const std::size_t robots = log.Texts("robots").size();
  if (!inputs.Has("map")) {
    if (options.start == "anywhere") throw InputError("start=anywhere needs the input 'map'");
    if (options.iterations == 0 && robots > 1)
      throw InputError("iterations=0 needs the input 'map' where there are several robots");
    return beginning;
  }
  if (options.starts > 1) throw InputError("with the input 'map' EM starts from it alone: take starts=1");
  beginning.settings.starts = 1;
  beginning.settings.loose_frame = false;  // the frame is the given map's
  beginning.schedule.prefix = 1.0;
  beginning.schedule.robots = static_cast<std::int64_t>(robots);
  beginning.given = ReadGivenMap(*inputs.Get("map"), log, beginning.settings);
  beginning.perception = PerceptionOf(beginning.given->map, beginning.settings.map);
  return beginning;
}

Carried MakeAllSteps(const Blob& log, const Options& options, const Beginning& beginning, cairn::Step* step,
                     std::vector<RobotSteps>* all) {
  const std::vector<std::string> robots = log.Texts("robots");
  const Settings& settings = beginning.settings;
  std::vector<bool> shared;
  if (beginning.given) shared = TypesIn(beginning.given->map);
  Carried carried;
  carried.blobs["settings"] = step->Share(settings.ToBlob());
  carried.odometry.assign(robots.size(), OdometryFit::Of(settings.noise));
  carried.overlap.assign(robots.size(), kOverlap);
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const bool anywhere = StartsAnywhere(options, r);
    const RobotSteps steps =
        MakeSteps(log.Sub(RobotPath(r)), robots[r], settings.steps, anywhere ? &shared : nullptr);
    if (shared.empty()) shared = TypesSeen(steps, settings.map);
    if (beginning.given && !anywhere) RefuseOutOfReach(beginning.given->map, steps, settings);
    carried.step_counts.push_back(steps.size());
    const int count = StepsInUse(beginning.schedule, steps.size());
    carried.work.push_back(anywhere && beginning.perception
                               ? WorkWhereLost(count, settings.Model(&*beginning.perception))
                               : WorkOf(ReckonOpenLoop(steps, settings.Model(nullptr), count).cells, count));
    carried.sharp.push_back(WorkOfStep(steps, settings.Model(nullptr)));
    carried.blobs["steps/" + std::to_string(r)] = step->Share(steps.ToBlob());
    all->push_back(steps);
  }
  return carried;
}

std::map<std::string, Blob> FirstBlobs(const Beginning& beginning) {
  std::map<std::string, Blob> blobs{{"history", EmptyHistory()},
                                    {"counts", StoredCounts(NoCounts(beginning.settings.map))}};
  if (beginning.given) {
    blobs["landmarks"] = ToBlob(beginning.given->landmarks);
    blobs["perception"] = beginning.perception->ToBlob();
  } else if (beginning.schedule.summarise) {
    blobs["landmarks"] = ToBlob(std::vector<Landmark>{});
  }
  return blobs;
}

}  // namespace cairn::landmark_map
