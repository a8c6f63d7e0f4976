#include "datasets/reproduce/landmarks/study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/common/log_parts.h"
#include "datasets/reproduce/study_inputs.h"
#include "datasets/simulate/loop.h"

namespace cairn::datasets {
namespace {

// A log of one robot without truth; observations are contact detections where `range_m` is NaN.
Blob MakeLog(const std::vector<double>& turn_rad, const std::vector<double>& forward_m,
             const std::vector<double>& seen_s, double range_m) {
  std::vector<double> time_s;
  for (std::size_t i = 0; i < turn_rad.size(); ++i) time_s.push_back(static_cast<double>(i + 1));
  const double bearing = std::isnan(range_m) ? range_m : 0.0;
  Blob log;
  log.Put("robots", Array::Texts({"1"}));
  log.Put("landmarks", Array::Texts({}));
  log.PutVector("robot/0/odometry/time_s", time_s);
  log.PutVector("robot/0/odometry/turn_rad", turn_rad);
  log.PutVector("robot/0/odometry/forward_m", forward_m);
  log.PutVector("robot/0/observations/time_s", seen_s);
  log.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>(seen_s.size(), -1));
  log.PutVector("robot/0/observations/range_m", std::vector<double>(seen_s.size(), range_m));
  log.PutVector("robot/0/observations/bearing_rad", std::vector<double>(seen_s.size(), bearing));
  return log;
}

// Figure 1: two ways of 40 m with a right turn between them. The contact detections only make the ends steps
// of the E-step; without a map they say nothing.
Blob MotionLog() {
  constexpr double kStepM = 0.5, kDegree = std::numbers::pi / 180.0;
  const auto steps = static_cast<std::size_t>(kStraightM / kStepM);
  std::vector<double> turn(2 * steps, 0.0), forward(2 * steps, kStepM);
  turn[steps] = -std::numbers::pi / 2;
  const auto half_s = static_cast<double>(steps);
  Blob log = MakeLog(turn, forward, {half_s, 2 * half_s}, std::numeric_limits<double>::quiet_NaN());
  log.PutScalar("noise/heading_drift_rad_per_m", 0.0);
  log.PutScalar("noise/heading_walk_rad_per_sqrt_m", 1.2 * kDegree);
  log.PutScalar("noise/forward_ratio", 0.03);
  log.PutScalar("noise/turn_ratio", 0.05);
  return log;
}

// Figure 2: a robot that stands anywhere sees a landmark 5 m ahead.
Blob PerceptionLog() {
  Blob log = MakeLog({0.0}, {0.0}, {1.0}, kSeenAtM);
  log.PutScalar("noise/range_m", 0.5);
  log.PutScalar("noise/bearing_rad", 0.1);
  return log;
}

// Two landmarks that look alike, on a grid of 0.25 m that leaves room for the robot.
Blob TwoLandmarks() {
  constexpr double kCellM = 0.25, kHalfX = kBetweenM / 2 + 8, kHalfY = 8;
  const auto columns = static_cast<std::int64_t>(2 * kHalfX / kCellM) + 1;
  const auto rows = static_cast<std::int64_t>(2 * kHalfY / kCellM) + 1;
  std::vector<double> cells(static_cast<std::size_t>(columns * rows), 1e-9);  // so that the grid is not cut
  for (const double x : {-kBetweenM / 2, kBetweenM / 2}) {
    const auto column = static_cast<std::int64_t>(std::lround((x + kHalfX) / kCellM));
    cells[static_cast<std::size_t>(rows / 2 * columns + column)] = 0.9;
  }
  Blob map;
  map.Put("robots", Array::Texts({"1"}));
  map.Put("landmarks", Array::Texts({}));
  map.Put("map/grid/probability", Array::Of<double>({1, rows, columns}, cells));
  map.PutScalar<double>("map/grid/origin_x_m", -kHalfX - kCellM / 2);
  map.PutScalar<double>("map/grid/origin_y_m", -kHalfY - kCellM / 2);
  map.PutScalar<double>("map/grid/cell_m", kCellM);
  map.PutVector<double>("map/landmark_x_m", {-kBetweenM / 2, kBetweenM / 2});
  map.PutVector<double>("map/landmark_y_m", {0.0, 0.0});
  map.Put("map/landmark_covariance_m2", Array::Of<double>({2, 2, 2}, {.01, 0, 0, .01, .01, 0, 0, .01}));
  map.PutVector<double>("map/landmark_count", {1.0, 1.0});
  map.PutVector<std::int32_t>("map/landmark_identity", {-1, -1});
  return map;
}

// Way of robot 0 up to each of its observations.
std::vector<double> DistancesTravelledTo(const Blob& log) {
  const auto time = log.Get<double>("robot/0/odometry/time_s"),
             forward = log.Get<double>("robot/0/odometry/forward_m"),
             seen = log.Get<double>("robot/0/observations/time_s");
  std::vector<double> travelled_to;
  double travelled = 0.0;
  std::size_t control = 0;
  for (const double at : seen) {
    for (; control < time.size() && time[control] <= at; ++control) travelled += std::abs(forward[control]);
    travelled_to.push_back(travelled);
  }
  return travelled_to;
}

struct Cycle {
  int observation = 0;  // counted from 1; 0: none
  double length_m = 0;  // since the same landmark was seen last
};

// The first cycle of at least a length that robot 0 closes. From the truth, which decides what is shown,
// never what is computed.
Cycle FirstCycle(const Blob& log, double at_least_m) {
  const auto truth = log.Get<std::int32_t>("truth/robot/0/observations/landmark");
  const std::vector<double> travelled_to = DistancesTravelledTo(log);
  for (std::size_t n = 0; n < truth.size(); ++n) {
    for (std::size_t k = n; k-- > 0;) {
      if (truth[k] != truth[n]) continue;
      const double length_m = travelled_to[n] - travelled_to[k];
      if (length_m >= at_least_m) return {static_cast<int>(n + 1), length_m};
      break;
    }
  }
  return {};
}

void FindCycles(LandmarkStudy* study) {
  constexpr double kLargeM = 100.0;  // the large cycle is 170 m round, a small one less than this
  const Blob& first = study->inputs.at("first");
  study->observations = static_cast<int>(first.Get<double>("robot/0/observations/time_s").size());
  study->closing = FirstCycle(first, kLargeM).observation;
  if (study->closing == 0) throw InputError("this seed's drive closes no large cycle: take another --seed");
  const Cycle small = FirstCycle(study->inputs.at("back"), 0);
  if (small.length_m >= kLargeM) return;
  study->revisit = small.observation;
  study->revisit_m = small.length_m;
}

class JobMaker {
 public:
  explicit JobMaker(LandmarkStudy* study) : job_(study->job) {}

  // Options are added to the stage that is returned.
  proto::Stage& Add(const std::string& name, const std::string& log, const std::string& map = "") {
    proto::Stage& stage = *job_.add_stages();
    stage.set_name(name);
    stage.set_pipeline("landmark_map");
    (*stage.mutable_inputs())["log"] = log;
    if (!map.empty()) (*stage.mutable_inputs())["map"] = map;
    (*stage.mutable_options())["beliefs"].set_b(true);
    return stage;
  }
  // EM as the paper ran it: one start, all data from the first iteration on, and the
  // map as EM leaves it.
  proto::Stage& AddPlainEm(const std::string& name, const std::string& log = "first") {
    proto::Stage& stage = Add(name, log);
    auto& options = *stage.mutable_options();
    options["starts"].set_i(1);
    options["growth_start"].set_d(1);
    options["refine"].set_b(false);
    return stage;
  }
  // Finds a robot in the map, forward only.
  proto::Stage& AddLocalization(const std::string& name, const std::string& log, const std::string& map) {
    proto::Stage& stage = Add(name, log, map);
    auto& options = *stage.mutable_options();
    options["iterations"].set_i(0);
    options["revise"].set_b(false);
    options["start"].set_s("anywhere");
    return stage;
  }

 private:
  proto::Job& job_;
};

void AddStages(LandmarkStudy* study) {
  JobMaker make(study);
  auto& motion = *make.Add("motion", "motion_log").mutable_options();
  motion["iterations"].set_i(0);
  motion["cell_m"].set_d(0.5);
  motion["heading_deg"].set_d(2);
  auto& seen = *make.AddLocalization("perception", "perception_log", "landmarks").mutable_options();
  seen["cell_m"].set_d(0.25);
  seen["prune"].set_d(0);
  make.Add("map", "first");
  make.AddPlainEm("em_map");
  for (int n = 1; n <= kShownIterations; ++n) {
    auto& early = *make.AddPlainEm(IterationsStage(n)).mutable_options();
    early["iterations"].set_i(n);
    early["tolerance"].set_d(0);
  }
  for (int n = std::max(2, study->closing - 2); n < study->observations; ++n)
    (*make.AddPlainEm(PrefixStage(n)).mutable_options())["prefix_observations"].set_i(n);
  if (study->revisit > 0)
    (*make.AddPlainEm("small_cycle", "back").mutable_options())["prefix_observations"].set_i(study->revisit);
  (*make.Add("forward", "first").mutable_options())["incremental"].set_b(true);
  make.AddLocalization("beta", "back", "em_map");
  make.AddLocalization("beta_early", "back", IterationsStage(2));
  make.Add("other_map", "other");
  make.AddLocalization("alpha", "second", "em_map");
  (*make.Add("joint", "both", "map").mutable_options())["iterations"].set_i(1);
}

}  // namespace

std::string IterationsStage(int iterations) { return "iterations_" + std::to_string(iterations); }

std::string PrefixStage(int observations) {
  return "prefix_" + std::string(observations < 10 ? "0" : "") + std::to_string(observations);
}

LandmarkStudy MakeLandmarkStudy(std::uint64_t seed) {
  LandmarkStudy study;
  const Blob both = SimulateLoop({.difficulty = "paper", .robots = 2, .seed = seed});
  study.inputs["both"] = both;
  study.inputs["first"] = RobotsOf(both, {0});
  study.inputs["second"] = RobotsOf(both, {1});
  study.inputs["back"] = Reversed(both, 0);
  study.inputs["other"] = SimulateLoop({.difficulty = "paper", .seed = seed + 1});
  study.inputs["motion_log"] = MotionLog();
  study.inputs["perception_log"] = PerceptionLog();
  study.inputs["landmarks"] = TwoLandmarks();
  study.job.set_name("reproduce-landmarks");
  study.job.set_seed(seed);
  FindCycles(&study);
  AddStages(&study);
  NameInputs(study.inputs, &study.job);
  return study;
}

}  // namespace cairn::datasets
