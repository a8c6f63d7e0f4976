// How soon robots with unknown starts are found in the map that another robot made, and whether all of them
// together map the place: on simulated loops.
//   localize_rate DIFFICULTY FIRST LAST [ROBOTS] [key=value …]
// Robot 1 maps the place from its own log. The others are then found in that map in one E-step, forward only:
// their most likely pose after their n-th observation owes nothing to later ones. It counts as right where it
// lies within 1 m and 10 degrees of truth, the map laid over truth by the rigid motion that fits its
// landmarks. Last, one job maps the logs of all robots together. The options are those of every job.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/landmarks.h"
#include "datasets/evaluate/track.h"
#include "datasets/log_parts.h"
#include "datasets/simulate_loop.h"
#include "pipelines/in_process.h"
#include "pipelines/registry.h"
#include "tests/bench/stage_option.h"

namespace cairn {
namespace {

using datasets::PoseM;

constexpr std::size_t kShown = 6;  // observations
constexpr std::size_t kAsked = 4;  // the fifth

struct Tally {
  int seeds = 0, robots = 0, all_robots = 0, joint = 0, mapped = 0;
  int right[kShown] = {};
  int by_asked = 0, all_by_asked = 0;
};

BlobPtr Run(const proto::Stage& stage, const Blob& log, const BlobPtr& map = nullptr) {
  std::map<std::string, BlobPtr> inputs{{"log", std::make_shared<const Blob>(log.Without("truth/"))}};
  if (map) inputs["map"] = map;
  return RunInProcess(*MakePipeline(stage, 0), inputs);
}

// The motion that lays the map's landmarks over the true ones.
datasets::Similarity Alignment(const Blob& map, const Blob& log, const datasets::Evaluation& score) {
  const auto ours = datasets::ReadPoints(map, "map/landmark_x_m", "map/landmark_y_m");
  const auto theirs = datasets::ReadPoints(log, "truth/landmarks/x_m", "truth/landmarks/y_m");
  std::vector<datasets::PointPair> pairs;
  for (const auto& [k, t] : score.pairs)
    pairs.push_back({ours[static_cast<std::size_t>(k)], theirs[static_cast<std::size_t>(t)]});
  return datasets::FitRigid(pairs);
}

// For each of a robot's first observations: is its most likely pose right?
std::vector<bool> RightPoses(const Blob& found, const Blob& log, std::size_t robot,
                             const datasets::Similarity& alignment, std::string* text) {
  const std::string prefix = "robot/" + std::to_string(robot) + "/";
  const datasets::Track poses = datasets::ReadTrack(found, prefix + "poses/", "mode_");
  const datasets::Track truth = datasets::ReadTrack(log, "truth/" + prefix + "poses/");
  const auto seen_s = log.Get<double>(prefix + "observations/time_s");
  std::vector<bool> right;
  for (std::size_t n = 0; n < std::min(kShown, seen_s.size()); ++n) {
    const auto ours = datasets::PoseAt(poses, seen_s[n]), theirs = datasets::PoseAt(truth, seen_s[n]);
    if (!ours || !theirs) {
      right.push_back(false);
      continue;
    }
    const PoseM moved = alignment(*ours);
    const double distance_m = std::hypot(moved.x_m - theirs->x_m, moved.y_m - theirs->y_m);
    const double turn = std::abs(datasets::WrapAngle(moved.heading_rad - theirs->heading_rad));
    right.push_back(distance_m <= 1.0 && turn <= 10.0 * std::numbers::pi / 180.0);
    char part[48];
    std::snprintf(part, sizeof part, " %.1f m/%.0f°", distance_m, turn * 180.0 / std::numbers::pi);
    *text += part;
  }
  return right;
}

void RunSeed(const datasets::SimulateLoopOptions& world, const proto::Stage& stage, Tally* tally) {
  const Blob log = datasets::SimulateLoop(world);
  const Blob first = datasets::RobotsOf(log, {0});
  std::vector<std::size_t> others;
  for (int r = 1; r < world.robots; ++r) others.push_back(static_cast<std::size_t>(r));
  const Blob rest = datasets::RobotsOf(log, others);
  const BlobPtr map = Run(stage, first);
  const datasets::Evaluation score = datasets::Evaluate(*map, first);
  const bool mapped = score.topology_correct.value_or(false);
  proto::Stage localize = stage;
  SetOption("iterations=0", &localize);
  SetOption("revise=false", &localize);
  SetOption("start=anywhere", &localize);
  const BlobPtr found = Run(localize, rest, map);
  const datasets::Similarity alignment = Alignment(*map, first, score);
  bool all = true, all_by = true;
  std::printf("seed %llu: robot 1's map %s\n", static_cast<unsigned long long>(world.seed),
              mapped ? "right" : "wrong");
  for (std::size_t r = 0; r < others.size(); ++r) {
    std::string text;
    const std::vector<bool> right = RightPoses(*found, rest, r, alignment, &text);
    for (std::size_t n = 0; n < right.size(); ++n) tally->right[n] += right[n] ? 1 : 0;
    all = all && right.size() > kAsked && right[kAsked];
    const bool by = std::find(right.begin(), right.begin() + std::min(right.size(), kAsked + 1), true) !=
                    right.begin() + std::min(right.size(), kAsked + 1);
    tally->by_asked += by ? 1 : 0;
    all_by = all_by && by;
    ++tally->robots;
    std::printf("  robot %zu:%s\n", r + 2, text.c_str());
  }
  const bool joint = datasets::Evaluate(*Run(stage, log), log).topology_correct.value_or(false);
  std::printf("  joint map %s\n", joint ? "right" : "wrong");
  std::fflush(stdout);
  ++tally->seeds;
  tally->mapped += mapped ? 1 : 0;
  tally->all_robots += all ? 1 : 0;
  tally->all_by_asked += all_by ? 1 : 0;
  tally->joint += joint ? 1 : 0;
}

int Main(const std::vector<std::string>& args) {
  if (args.size() < 3) {
    std::fprintf(stderr, "usage: localize_rate DIFFICULTY FIRST LAST [ROBOTS] [key=value ...]\n");
    return 2;
  }
  datasets::SimulateLoopOptions world;
  world.difficulty = args[0];
  world.robots = 4;
  proto::Stage stage;
  stage.set_name("landmarks");
  stage.set_pipeline("landmark_map");
  for (std::size_t i = 3; i < args.size(); ++i) {
    if (args[i].find('=') == std::string::npos)
      world.robots = std::max(2, std::atoi(args[i].c_str()));
    else
      SetOption(args[i], &stage);
  }
  Tally tally;
  for (int seed = std::atoi(args[1].c_str()); seed <= std::atoi(args[2].c_str()); ++seed) {
    world.seed = static_cast<std::uint64_t>(seed);
    RunSeed(world, stage, &tally);
  }
  std::printf("%s, seeds %s to %s, %d robots: robot 1's map right in %d of %d; the others found",
              args[0].c_str(), args[1].c_str(), args[2].c_str(), world.robots, tally.mapped, tally.seeds);
  for (std::size_t n = 0; n < kShown; ++n) std::printf(" %d", tally.right[n]);
  std::printf(
      " of %d times at observation 1, 2, ...; at one of the first five %d times; all of a seed's robots at "
      "the fifth in %d of %d, at one of the first five in %d; joint map right in %d\n",
      tally.robots, tally.by_asked, tally.all_robots, tally.seeds, tally.all_by_asked, tally.joint);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  try {
    return cairn::Main({argv + 1, argv + argc});
  } catch (const cairn::InputError& error) {
    std::fprintf(stderr, "localize_rate: %s\n", error.what());
    return 2;
  }
}
