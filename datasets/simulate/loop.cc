#include "datasets/simulate/loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/common/control.h"
#include "datasets/simulate/rows.h"
#include "datasets/simulate/sonar.h"
#include "datasets/simulate/walls.h"
#include "datasets/simulate/world.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;
constexpr int kMaxRobots = 64;
constexpr int kMaxTours = 10000;
constexpr double kNominalSpread = 1.5;

// Streams of the generator: the world's, the data sheet's, then one for each robot. What options add draws
// from substreams, so that they change nothing else.
constexpr std::uint64_t kLoopWorldStream = 0, kNominalStream = 1, kRobotStream = 2;
constexpr std::uint32_t kSensingSubstream = 1, kLoopSonarSubstream = 2;
constexpr int kMaxDrives = 20;

LoopDifficulty Make(const char* name, double path_m, double step_m, int min_contacts, int max_contacts,
                    double drift_deg_per_m, double walk_deg_per_sqrt_m, ErrorRange final_error) {
  LoopDifficulty d;
  d.name = name;
  d.min_path_m = path_m;
  d.step_m = step_m;
  d.min_contacts = min_contacts;
  d.max_contacts = max_contacts;
  d.noise.heading_drift_rad_per_m = drift_deg_per_m * kDegree_rad;
  d.noise.heading_walk_rad_per_sqrt_m = walk_deg_per_sqrt_m * kDegree_rad;
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
  all.push_back(Make("museum", 735, 0.275, 50, 50, 0.2, 0.5, {65, 75, 165 * kDegree_rad}));
  return all;
}

Drive DrawFittingDrive(const CorridorWorld& world, const LoopDifficulty& difficulty, Rng& rng) {
  DriveOptions options;
  options.min_length_m = difficulty.min_path_m;
  options.step_m = difficulty.step_m;
  for (int i = 0; i < kMaxTours; ++i) {
    Drive drive = DrawDrive(world, options, rng);
    const int contacts = static_cast<int>(drive.contacts.size());
    if (contacts >= difficulty.min_contacts && contacts <= difficulty.max_contacts) return drive;
  }
  throw InputError("no tour of this world has " + std::to_string(difficulty.min_contacts) + " to " +
                   std::to_string(difficulty.max_contacts) + " contact detections: take another seed");
}

double Round(double value, double unit) { return std::round(value / unit) * unit; }
// To one digit where that stays within half of `exact`, else to two.
double PerturbedNoise(double exact, Rng& rng) {
  const double log_spread = std::log(kNominalSpread);
  const double figure = exact * std::exp(rng.Uniform(-log_spread, log_spread));
  const double unit = std::pow(10, std::floor(std::log10(figure)));
  const double one_digit = Round(figure, unit);
  return std::abs(one_digit - exact) <= 0.5 * exact ? one_digit : Round(figure, unit / 10);
}

// Angles are rounded in degrees, as people read them.
void PutNoiseParameters(const LoopDifficulty& difficulty, const LoopSensing& sensing, Rng& rng, Blob& log) {
  const OdometryNoise& noise = difficulty.noise;
  log.PutScalar("noise/heading_drift_rad_per_m",
                PerturbedNoise(noise.heading_drift_rad_per_m / kDegree_rad, rng) * kDegree_rad);
  log.PutScalar("noise/heading_walk_rad_per_sqrt_m",
                PerturbedNoise(noise.heading_walk_rad_per_sqrt_m / kDegree_rad, rng) * kDegree_rad);
  log.PutScalar("noise/forward_ratio", PerturbedNoise(noise.forward_ratio, rng));
  log.PutScalar("noise/turn_ratio", PerturbedNoise(noise.turn_ratio, rng));
  if (!sensing.ranged()) log.PutScalar("noise/contact_m", PerturbedNoise(DriveOptions{}.pass_sd_m, rng));
}

void PutConfusion(const LoopSensing& sensing, Rng& rng, Blob& log) {
  const double wrong = sensing.confusion > 0 ? PerturbedNoise(sensing.confusion, rng) : 0;
  std::vector<std::string> names;
  std::vector<double> matrix;
  for (int k = 0; k < sensing.types; ++k) {
    names.push_back("type " + std::to_string(k));
    for (int j = 0; j < sensing.types; ++j)
      matrix.push_back(j == k ? 1 - wrong : wrong / (sensing.types - 1));
  }
  log.Put("types", Array::Texts(names));
  log.Put("noise/type_confusion", Array::Of<double>({sensing.types, sensing.types}, matrix));
}

// What the sensing's options add to the data sheet.
void PutSensorParameters(const LoopSensing& sensing, Rng& rng, Blob& log) {
  if (sensing.ranged()) {
    log.PutScalar("noise/range_m", PerturbedNoise(kCameraRangeSdM, rng));
    log.PutScalar("noise/bearing_rad", PerturbedNoise(kCameraBearingSdRad / kDegree_rad, rng) * kDegree_rad);
    log.PutScalar("sensor/max_range_m", kCameraMaxRangeM);
    log.PutScalar("sensor/field_of_view_rad", kCameraViewRad);
  }
  if (sensing.false_rate > 0 || sensing.miss_rate > kDriveMissRate) {
    if (sensing.false_rate > 0) log.PutScalar("noise/false_ratio", PerturbedNoise(sensing.false_rate, rng));
    log.PutScalar("noise/miss_ratio", PerturbedNoise(sensing.miss_rate, rng));
  }
  if (sensing.types > 1) PutConfusion(sensing, rng, log);
}

void PutObservations(const std::string& robot, const Drive& drive, const std::vector<Sensed>& sensed,
                     bool typed, Blob& log) {
  std::vector<double> time, range, bearing;
  std::vector<std::int32_t> landmark, type, truth;
  for (const Sensed& s : sensed) {
    time.push_back(ToMilli(drive.times_s[s.control]));
    landmark.push_back(s.identity);
    type.push_back(s.type);
    range.push_back(std::isnan(s.range_m) ? s.range_m : ToMilli(s.range_m));
    bearing.push_back(std::isnan(s.bearing_rad) ? s.bearing_rad : ToNanoAngle(s.bearing_rad));
    truth.push_back(s.landmark);
  }
  kinds::Log::Observations observations{time, range, bearing, landmark, {}};
  if (typed) observations.type = type;
  PutFields(robot + "/observations/", observations, &log);
  log.PutVector("truth/" + robot + "/observations/landmark", truth);
}

// The landmarks' types: none where all look alike.
std::vector<int> DrawTypes(const CorridorWorld& world, const SimulateLoopOptions& options) {
  Rng rng(options.seed, kLoopWorldStream, kSensingSubstream);
  std::vector<int> types;
  for (std::size_t i = 0; i < world.nodes.size() && options.sensing.types > 1; ++i)
    types.push_back(static_cast<int>(rng.Below(static_cast<std::uint64_t>(options.sensing.types))));
  return types;
}

void PutLandmarks(const CorridorWorld& world, const std::vector<int>& types, bool identities, Blob& log) {
  log.Put("landmarks", Array::Texts(identities ? world.names : std::vector<std::string>{}));
  kinds::Log::Landmarks truth{world.names,
                              ColumnOf(world.nodes, [](const Point& node) { return ToMicro(node.x_m); }),
                              ColumnOf(world.nodes, [](const Point& node) { return ToMicro(node.y_m); }),
                              {}};
  if (!types.empty()) truth.type = types;
  PutFields("truth/landmarks/", truth, &log);
}

struct Driven {
  Drive drive;
  OdometryDraw odometry;
};

Driven DriveAndMeasure(const CorridorWorld& world, const LoopDifficulty& difficulty, Rng& rng) {
  for (int i = 0; i < kMaxDrives; ++i) {
    Driven driven{DrawFittingDrive(world, difficulty, rng), {}};
    auto odometry = DrawOdometry(driven.drive, difficulty.noise, difficulty.final_error, rng);
    if (!odometry) continue;
    driven.odometry = std::move(*odometry);
    return driven;
  }
  throw InputError("no drive ends with an odometric error of " +
                   std::to_string(difficulty.final_error.low_m) + " to " +
                   std::to_string(difficulty.final_error.high_m) + " m: take another seed");
}

}  // namespace

const std::vector<LoopDifficulty>& LoopDifficulties() {
  static const std::vector<LoopDifficulty> difficulties = MakeDifficulties();
  return difficulties;
}

const LoopDifficulty& LoopDifficultyOf(const std::string& name) {
  std::string names;
  for (const LoopDifficulty& d : LoopDifficulties()) {
    if (d.name == name) return d;
    names += (names.empty() ? "" : ", ") + d.name;
  }
  throw InputError("no difficulty '" + name + "'; there are " + names);
}

Blob SimulateLoop(const SimulateLoopOptions& options) {
  const LoopDifficulty& difficulty = LoopDifficultyOf(options.difficulty);
  if (options.robots < 1 || options.robots > kMaxRobots) {
    throw InputError("robots is " + std::to_string(options.robots) + "; allowed is 1 to " +
                     std::to_string(kMaxRobots));
  }
  Check(options.sensing);
  Rng world_rng(options.seed, kLoopWorldStream);
  const CorridorWorld world = MakeLoopWorld(difficulty.box_m, world_rng);
  const std::vector<int> types = DrawTypes(world, options);
  const std::vector<Wall> walls = options.sonar ? WallsOf(world) : std::vector<Wall>{};
  Blob log;
  PutLandmarks(world, types, options.sensing.identities, log);
  Rng nominal_rng(options.seed, kNominalStream);
  PutNoiseParameters(difficulty, options.sensing, nominal_rng, log);
  Rng sheet_rng(options.seed, kNominalStream, kSensingSubstream);
  PutSensorParameters(options.sensing, sheet_rng, log);
  if (options.sonar) {
    PutWalls(walls, log);
    Rng sonar_rng(options.seed, kNominalStream, kLoopSonarSubstream);
    log.PutScalar("noise/sonar_m", PerturbedNoise(kSonarSdM, sonar_rng));
  }
  std::vector<std::string> names;
  for (int r = 0; r < options.robots; ++r) {
    const std::uint64_t stream = kRobotStream + static_cast<std::uint64_t>(r);
    Rng rng(options.seed, stream);
    const auto [drive, odometry] = DriveAndMeasure(world, difficulty, rng);
    const std::string robot = "robot/" + std::to_string(r);
    PutOdometry(robot, drive, odometry, log);
    Rng sensing_rng(options.seed, stream, kSensingSubstream);
    PutObservations(robot, drive, Sense(drive, world, types, options.sensing, sensing_rng),
                    options.sensing.types > 1, log);
    PutPoses("truth/" + robot + "/poses/", drive, log);
    Rng sonar_rng(options.seed, stream, kLoopSonarSubstream);
    if (options.sonar) PutSonar(robot, drive, Milli(drive.times_s), walls, sonar_rng, log);
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
  Pose pose{x[0], y[0], heading[0]};
  for (std::size_t i = 0; i < turn.size(); ++i) pose = Apply(pose, {turn[i], forward[i]});
  return DistanceM({pose.x_m, pose.y_m}, {x.back(), y.back()});
}

}  // namespace cairn::datasets
