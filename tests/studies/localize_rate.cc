// How soon robots with unknown starts are found in the map that another robot made, and whether all of them
// together map the place: on simulated loops.
//   localize_rate DIFFICULTY FIRST LAST [ROBOTS] [--scale] [key=value …]
// Robot 1 maps the place from its own log. The others are then found in that map in one E-step: forward only,
// where the most likely pose at the n-th observation owes nothing to later ones, and with the past revised.
// It counts as right within 1 m and 10 degrees of truth, the map laid over truth by the rigid motion that
// fits its landmarks, and as the right place within 3 m and 20 degrees: landmarks themselves are 0.7 m off.
// Last, one job maps the logs of all robots together. The options are those of every job.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "datasets/common/log_parts.h"
#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/landmarks.h"
#include "datasets/evaluate/track.h"
#include "datasets/simulate/loop.h"
#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/stage_option.h"

namespace cairn {
namespace {

constexpr std::size_t kShown = 6;  // observations
constexpr std::size_t kAsked = 4;  // the fifth

// How far a pose is from truth.
struct Off {
  double m = HUGE_VAL, rad = HUGE_VAL;
  bool Within(double limit_m, double limit_deg) const {
    return m <= limit_m && rad <= limit_deg * std::numbers::pi / 180.0;
  }
  bool Right() const { return Within(1.0, 10.0); }
  bool RightPlace() const { return Within(3.0, 20.0); }  // whatever the map's own error
};

// Of one way to find robots in the map.
struct Count {
  int right[kShown] = {};                                    // at each observation
  int right_by = 0;                                          // at one of the first kAsked + 1
  int right_place = 0;                                       // at kAsked
  int all_right = 0, all_right_by = 0, all_right_place = 0;  // all robots of a seed
};

struct Tally {
  int seeds = 0, robots = 0, mapped = 0, joint = 0;
  Count forward, revised;
};

BlobPtr Run(const proto::Stage& stage, const Blob& log, const BlobPtr& map = nullptr) {
  std::map<std::string, BlobPtr> inputs{{"log", std::make_shared<const Blob>(log.Without("truth/"))}};
  if (map) inputs["map"] = map;
  return RunInProcess(*MakePipeline(stage, 0), inputs);
}

// The motion that lays the map's landmarks over the true ones.
datasets::Similarity Alignment(const Blob& map, const Blob& log, const datasets::Evaluation& score,
                               bool with_scale) {
  const auto ours =
      datasets::PointsOf(map.Get<double>("map/landmark_x_m"), map.Get<double>("map/landmark_y_m"));
  const auto theirs =
      datasets::PointsOf(log.Get<double>("truth/landmarks/x_m"), log.Get<double>("truth/landmarks/y_m"));
  std::vector<datasets::PointPair> pairs;
  for (const auto& [k, t] : score.pairs)
    pairs.push_back({ours[static_cast<std::size_t>(k)], theirs[static_cast<std::size_t>(t)]});
  return with_scale ? datasets::FitSimilarity(pairs) : datasets::FitRigid(pairs);
}

// At each of a robot's first observations.
std::vector<Off> PosesOff(const Blob& found, const Blob& log, std::size_t robot,
                          const datasets::Similarity& alignment) {
  const std::string prefix = "robot/" + std::to_string(robot) + "/";
  const datasets::Track poses = datasets::TrackOf(kinds::LikeliestPoses(prefix + "poses/", found));
  const datasets::Track truth = datasets::ReadTrack(log, "truth/" + prefix + "poses/");
  const auto seen_s = log.Get<double>(prefix + "observations/time_s");
  std::vector<Off> off(kShown);
  for (std::size_t n = 0; n < std::min(kShown, seen_s.size()); ++n) {
    const auto ours = datasets::PoseAt(poses, seen_s[n]), theirs = datasets::PoseAt(truth, seen_s[n]);
    if (!ours || !theirs) continue;
    const Pose moved = alignment(*ours);
    off[n] = {std::hypot(moved.x_m - theirs->x_m, moved.y_m - theirs->y_m),
              std::abs(WrapAngle(moved.heading_rad - theirs->heading_rad))};
  }
  return off;
}

// Of all robots of a seed.
void Add(const std::vector<std::vector<Off>>& robots, Count* count) {
  bool all = true, all_by = true, all_place = true;
  for (const std::vector<Off>& off : robots) {
    for (std::size_t n = 0; n < kShown; ++n) count->right[n] += off[n].Right() ? 1 : 0;
    const bool by = std::any_of(off.begin(), off.begin() + kAsked + 1, [](Off o) { return o.Right(); });
    count->right_by += by ? 1 : 0;
    count->right_place += off[kAsked].RightPlace() ? 1 : 0;
    all = all && off[kAsked].Right();
    all_by = all_by && by;
    all_place = all_place && off[kAsked].RightPlace();
  }
  count->all_right += all ? 1 : 0;
  count->all_right_by += all_by ? 1 : 0;
  count->all_right_place += all_place ? 1 : 0;
}

void Print(const char* how, const Count& count, const Tally& tally) {
  std::printf("%s: right at observation 1, 2, ...:", how);
  for (const int right : count.right) std::printf(" %d", right);
  std::printf(" of %d robots; at one of the first five %d; in the right place at the fifth %d\n",
              tally.robots, count.right_by, count.right_place);
  std::printf(
      "  all robots of a seed: right at the fifth %d, at one of the first five %d, in the right place at "
      "the fifth %d of %d\n",
      count.all_right, count.all_right_by, count.all_right_place, tally.seeds);
}

// Whether one job makes the right map from all robots' logs; what it refuses is none.
bool MapsAll(const proto::Stage& stage, const Blob& log) {
  try {
    const bool right = datasets::Evaluate(*Run(stage, log), log).topology_correct.value_or(false);
    std::printf("  joint map %s\n", right ? "right" : "wrong");
    return right;
  } catch (const InputError& error) {
    std::printf("  joint map refused: %s\n", error.what());
    return false;
  }
}

void RunSeed(const datasets::SimulateLoopOptions& world, const proto::Stage& stage, bool with_scale,
             Tally* tally) {
  const Blob log = datasets::SimulateLoop(world);
  const Blob first = datasets::RobotsOf(log, {0});
  std::vector<std::size_t> others;
  for (int r = 1; r < world.robots; ++r) others.push_back(static_cast<std::size_t>(r));
  const Blob rest = datasets::RobotsOf(log, others);
  const BlobPtr map = Run(stage, first);
  const datasets::Evaluation score = datasets::Evaluate(*map, first);
  const datasets::Similarity alignment = Alignment(*map, first, score, with_scale);
  const bool mapped = score.topology_correct.value_or(false);
  std::printf("seed %llu: robot 1's map %s, %.2f m\n", static_cast<unsigned long long>(world.seed),
              mapped ? "right" : "wrong", score.landmarks->rmse_m.value_or(NAN));
  proto::Stage localize = stage;
  SetOption("iterations=0", &localize);
  SetOption("start=anywhere", &localize);
  for (Count* count : {&tally->forward, &tally->revised}) {
    SetOption(count == &tally->forward ? "revise=false" : "revise=true", &localize);
    const BlobPtr found = Run(localize, rest, map);
    std::vector<std::vector<Off>> robots;
    for (std::size_t r = 0; r < others.size(); ++r) {
      robots.push_back(PosesOff(*found, rest, r, alignment));
      std::printf("  robot %zu, %s:", r + 2, count == &tally->forward ? "forward" : "revised");
      for (const Off& off : robots.back())
        std::printf(" %.1f m/%.0f°", off.m, off.rad * 180 / std::numbers::pi);
      std::printf("\n");
    }
    Add(robots, count);
  }
  const bool joint = MapsAll(stage, log);
  std::fflush(stdout);
  ++tally->seeds;
  tally->robots += static_cast<int>(others.size());
  tally->mapped += mapped ? 1 : 0;
  tally->joint += joint ? 1 : 0;
}

int Main(const std::vector<std::string>& args) {
  if (args.size() < 3) {
    std::fprintf(stderr, "usage: localize_rate DIFFICULTY FIRST LAST [ROBOTS] [--scale] [key=value ...]\n");
    return 2;
  }
  datasets::SimulateLoopOptions world;
  world.difficulty = args[0];
  world.robots = 4;
  bool with_scale = false;
  proto::Stage stage;
  stage.set_name("landmarks");
  stage.set_pipeline("landmark_map");
  for (std::size_t i = 3; i < args.size(); ++i) {
    if (args[i] == "--scale")
      with_scale = true;
    else if (args[i].find('=') == std::string::npos)
      world.robots = std::max(2, std::atoi(args[i].c_str()));
    else
      SetOption(args[i], &stage);
  }
  Tally tally;
  for (int seed = std::atoi(args[1].c_str()); seed <= std::atoi(args[2].c_str()); ++seed) {
    world.seed = static_cast<std::uint64_t>(seed);
    RunSeed(world, stage, with_scale, &tally);
  }
  std::printf("%s, seeds %s to %s, %d robots: robot 1's map right in %d of %d, the joint map in %d\n",
              args[0].c_str(), args[1].c_str(), args[2].c_str(), world.robots, tally.mapped, tally.seeds,
              tally.joint);
  Print("forward only", tally.forward, tally);
  Print("one E-step", tally.revised, tally);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("localize_rate", cairn::Main, argc, argv); }
