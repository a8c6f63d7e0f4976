#include "datasets/simulate_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/simulate_world.h"

namespace cairn::datasets {
namespace {

constexpr double kDeg = std::numbers::pi / 180;
constexpr int kMaxRobots = 64;
constexpr int kMaxTours = 10000;
constexpr double kNominalSpread = 1.5;

// Streams of the generator: the world's, the data sheet's, then one for each robot.
constexpr std::uint64_t kWorldStream = 0, kNominalStream = 1, kRobotStream = 2;

LoopDifficulty Make(const char* name, double path_m, double step_m, int min_presses, int max_presses,
                    double drift_deg_per_m, double walk_deg_per_sqrt_m, ErrorRange final_error) {
  LoopDifficulty d;
  d.name = name;
  d.min_path_m = path_m;
  d.step_m = step_m;
  d.min_presses = min_presses;
  d.max_presses = max_presses;
  d.noise.heading_drift_rad_per_m = drift_deg_per_m * kDeg;
  d.noise.heading_walk_rad_per_sqrt_m = walk_deg_per_sqrt_m * kDeg;
  d.final_error = final_error;
  return d;
}

std::vector<LoopDifficulty> MakeDifficulties() {
  constexpr int kAny = 1000000;
  std::vector<LoopDifficulty> all;
  all.push_back(Make("paper", 330, 0.13, 21, 24, 0.15, 0.8, {22, 28}));
  all.push_back(Make("base", 1000, 0.33, 65, 70, 0.06, 0.5, {22, 28}));
  all.push_back(Make("hard", 1000, 0.33, 65, 70, 0.2, 1.0, {45, 55}));
  all.push_back(Make("extreme", 600, 0.33, 0, kAny, 0.3, 1.0, {60, 120}));
  all.back().box_m = 150;
  return all;
}

const LoopDifficulty& FindDifficulty(const std::string& name) {
  std::string names;
  for (const LoopDifficulty& d : LoopDifficulties()) {
    if (d.name == name) return d;
    names += (names.empty() ? "" : ", ") + d.name;
  }
  throw InputError("no difficulty '" + name + "'; there are " + names);
}

Drive DrawFittingDrive(const CorridorWorld& world, const LoopDifficulty& difficulty, Rng& rng) {
  DriveOptions options;
  options.min_length_m = difficulty.min_path_m;
  options.step_m = difficulty.step_m;
  for (int i = 0; i < kMaxTours; ++i) {
    Drive drive = DrawDrive(world, options, rng);
    const int presses = static_cast<int>(drive.presses.size());
    if (presses >= difficulty.min_presses && presses <= difficulty.max_presses) return drive;
  }
  throw InputError("no tour of this world has " + std::to_string(difficulty.min_presses) + " to " +
                   std::to_string(difficulty.max_presses) + " presses: take another seed");
}

double Round(double value, double unit) { return std::round(value / unit) * unit; }
double ToMilli(double value) { return std::round(value * 1e3) / 1e3; }
double ToMicro(double value) { return std::round(value * 1e6) / 1e6; }
// A nanoradian; never beyond pi, which does not end there.
double ToNanoAngle(double angle_rad) { return std::min(std::round(angle_rad * 1e9) / 1e9, 3.141592653); }

// To one digit where that stays within half of `exact`, else to two.
double NominalFigure(double exact, Rng& rng) {
  const double log_spread = std::log(kNominalSpread);
  const double figure = exact * std::exp(rng.Uniform(-log_spread, log_spread));
  const double unit = std::pow(10, std::floor(std::log10(figure)));
  const double one_digit = Round(figure, unit);
  return std::abs(one_digit - exact) <= 0.5 * exact ? one_digit : Round(figure, unit / 10);
}

// Angles are rounded in degrees, as people read them.
void PutNominalNoise(const LoopDifficulty& difficulty, double press_sd_m, Rng& rng, Blob& log) {
  const OdometryNoise& noise = difficulty.noise;
  log.PutScalar("noise/heading_drift_rad_per_m",
                NominalFigure(noise.heading_drift_rad_per_m / kDeg, rng) * kDeg);
  log.PutScalar("noise/heading_walk_rad_per_sqrt_m",
                NominalFigure(noise.heading_walk_rad_per_sqrt_m / kDeg, rng) * kDeg);
  log.PutScalar("noise/forward_ratio", NominalFigure(noise.forward_ratio, rng));
  log.PutScalar("noise/turn_ratio", NominalFigure(noise.turn_ratio, rng));
  log.PutScalar("noise/press_m", NominalFigure(press_sd_m, rng));
}

void PutOdometry(const std::string& robot, const Drive& drive, const OdometryDraw& odometry, Blob& log) {
  std::vector<double> time, turn, forward;
  for (std::size_t i = 0; i < odometry.controls.size(); ++i) {
    time.push_back(ToMilli(drive.times_s[i]));
    turn.push_back(odometry.controls[i].turn_rad);
    forward.push_back(odometry.controls[i].forward_m);
  }
  log.PutVector(robot + "/odometry/time_s", time);
  log.PutVector(robot + "/odometry/turn_rad", turn);
  log.PutVector(robot + "/odometry/forward_m", forward);
}

void PutPresses(const std::string& robot, const Drive& drive, Blob& log) {
  std::vector<double> time;
  std::vector<std::int32_t> truth;
  for (const Press& press : drive.presses) {
    time.push_back(ToMilli(drive.times_s[press.control]));
    truth.push_back(static_cast<std::int32_t>(press.landmark));
  }
  const std::vector<double> nan(time.size(), std::numeric_limits<double>::quiet_NaN());
  log.PutVector(robot + "/observations/time_s", time);
  log.PutVector(robot + "/observations/landmark", std::vector<std::int32_t>(time.size(), -1));
  log.PutVector(robot + "/observations/range_m", nan);
  log.PutVector(robot + "/observations/bearing_rad", nan);
  log.PutVector("truth/" + robot + "/observations/landmark", truth);
}

void PutTruePoses(const std::string& robot, const Drive& drive, Blob& log) {
  std::vector<double> time, x, y, heading;
  const auto add = [&](double time_s, const PoseM& pose) {
    time.push_back(ToMilli(time_s));
    x.push_back(ToMicro(pose.x_m));
    y.push_back(ToMicro(pose.y_m));
    heading.push_back(ToNanoAngle(pose.heading_rad));
  };
  PoseM pose = drive.start;
  add(0, pose);
  for (std::size_t i = 0; i < drive.controls.size(); ++i) {
    pose = Apply(pose, drive.controls[i]);
    add(drive.times_s[i], pose);
  }
  const std::string poses = "truth/" + robot + "/poses/";
  log.PutVector(poses + "time_s", time);
  log.PutVector(poses + "x_m", x);
  log.PutVector(poses + "y_m", y);
  log.PutVector(poses + "heading_rad", heading);
}

void PutLandmarks(const CorridorWorld& world, Blob& log) {
  std::vector<double> x, y;
  for (const PointM& node : world.nodes) {
    x.push_back(ToMicro(node.x_m));
    y.push_back(ToMicro(node.y_m));
  }
  log.Put("landmarks", Array::Texts({}));
  log.Put("truth/landmarks/name", Array::Texts(world.names));
  log.PutVector("truth/landmarks/x_m", x);
  log.PutVector("truth/landmarks/y_m", y);
}

}  // namespace

const std::vector<LoopDifficulty>& LoopDifficulties() {
  static const std::vector<LoopDifficulty> difficulties = MakeDifficulties();
  return difficulties;
}

Blob SimulateLoop(const SimulateLoopOptions& options) {
  const LoopDifficulty& difficulty = FindDifficulty(options.difficulty);
  if (options.robots < 1 || options.robots > kMaxRobots) {
    throw InputError("robots is " + std::to_string(options.robots) + "; allowed is 1 to " +
                     std::to_string(kMaxRobots));
  }
  Rng world_rng(options.seed, kWorldStream);
  const CorridorWorld world = MakeLoopWorld(difficulty.box_m, world_rng);
  Blob log;
  PutLandmarks(world, log);
  Rng nominal_rng(options.seed, kNominalStream);
  PutNominalNoise(difficulty, DriveOptions{}.pass_sd_m, nominal_rng, log);
  std::vector<std::string> names;
  for (int r = 0; r < options.robots; ++r) {
    Rng rng(options.seed, kRobotStream + static_cast<std::uint64_t>(r));
    const Drive drive = DrawFittingDrive(world, difficulty, rng);
    const OdometryDraw odometry = DrawOdometry(drive, difficulty.noise, difficulty.final_error, rng);
    const std::string robot = "robot/" + std::to_string(r);
    PutOdometry(robot, drive, odometry, log);
    PutPresses(robot, drive, log);
    PutTruePoses(robot, drive, log);
    names.push_back("robot " + std::to_string(r));
  }
  log.Put("robots", Array::Texts(names));
  return log;
}

double FinalOdometricErrorM(const Blob& log, int robot) {
  const std::string prefix = "robot/" + std::to_string(robot);
  const auto turn = log.Get<double>(prefix + "/odometry/turn_rad");
  const auto forward = log.Get<double>(prefix + "/odometry/forward_m");
  const auto x = log.Get<double>("truth/" + prefix + "/poses/x_m");
  const auto y = log.Get<double>("truth/" + prefix + "/poses/y_m");
  const auto heading = log.Get<double>("truth/" + prefix + "/poses/heading_rad");
  if (x.empty() || y.size() != x.size() || heading.size() != x.size() || turn.size() != forward.size()) {
    throw InputError(prefix + ": columns of odometry or true poses differ in length, or are empty");
  }
  PoseM pose{x[0], y[0], heading[0]};
  for (std::size_t i = 0; i < turn.size(); ++i) pose = Apply(pose, {turn[i], forward[i]});
  return DistanceM({pose.x_m, pose.y_m}, {x.back(), y.back()});
}

}  // namespace cairn::datasets
