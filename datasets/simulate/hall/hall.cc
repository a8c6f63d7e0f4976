#include "datasets/simulate/hall/hall.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "datasets/common/control.h"
#include "datasets/simulate/echo.h"
#include "datasets/simulate/hall/world.h"
#include "datasets/simulate/loop.h"
#include "datasets/simulate/odometry.h"
#include "datasets/simulate/rows.h"
#include "datasets/simulate/sonar.h"

namespace cairn::datasets {
namespace {

constexpr double kDeg = std::numbers::pi / 180;
constexpr double kHallSpeedMps = 0.4;
constexpr int kMostDoorReadings = 24;
constexpr double kNarrowestM = 0.3, kWidestM = 1.8;  // doors
constexpr int kMostDraws = 100;

// Streams of the generator.
constexpr std::uint64_t kPlanStream = 0, kDriveStream = 1, kLuckStream = 2, kOdometryStream = 3;

// Where somebody is at a time when the robot is there.
using Walker = std::function<std::optional<Point>(double time_s, const Pose& robot)>;

struct Visit {
  HallPlan plan;
  Drive drive;
  std::vector<Pose> poses;  // at each control's end, where the robot listens
  std::vector<Luck> luck;   // of each scan's readings
  Walker walker;            // may be empty
};

// Along x, weaving by a few degrees.
Drive DrawWeave(double from_x_m, int steps, double step_m, Rng& rng) {
  const double swing_rad = rng.Uniform(2, 4) * kDeg, wave_m = rng.Uniform(3, 5);
  const double phase = rng.Uniform(0, 2 * std::numbers::pi);
  const auto heading = [&](int i) {
    return swing_rad * std::sin(2 * std::numbers::pi * step_m * i / wave_m + phase);
  };
  Drive drive;
  drive.start = {from_x_m, 0, heading(0)};
  double time_s = 0;
  for (int i = 1; i <= steps; ++i) {
    time_s += step_m / kHallSpeedMps * (1 + 0.03 * std::clamp(rng.Normal(), -3.0, 3.0));
    drive.controls.push_back({heading(i) - heading(i - 1), step_m});
    drive.times_s.push_back(time_s);
    drive.length_m += step_m;
  }
  return drive;
}

Visit DrawVisit(HallPlan plan, double from_x_m, int steps, double step_m, std::uint64_t seed, int draw = 0) {
  const auto substream = static_cast<std::uint32_t>(draw);
  Rng drive_rng(seed, kDriveStream, substream), luck_rng(seed, kLuckStream, substream);
  Visit visit{std::move(plan), DrawWeave(from_x_m, steps, step_m, drive_rng), {}, {}, {}};
  Pose pose = visit.drive.start;
  for (const Control& control : visit.drive.controls) {
    visit.poses.push_back(pose = Apply(pose, control));
    for (int beam = 0; beam < kSonars; ++beam) visit.luck.push_back(DrawLuck({}, luck_rng));
  }
  return visit;
}

std::vector<Sounding> ListenAll(const Visit& visit, const Hall& hall) {
  const std::vector<Obstacle> around = ObstaclesOf(hall);
  const RangeRing ring;
  std::vector<Sounding> heard;
  for (std::size_t scan = 0; scan < visit.poses.size(); ++scan) {
    const Pose& pose = visit.poses[scan];
    std::vector<Point> persons;
    if (visit.walker) {
      if (const auto at = visit.walker(visit.drive.times_s[scan], pose)) persons.push_back(*at);
    }
    for (int beam = 0; beam < kSonars; ++beam)
      heard.push_back(Listen(around, ring, pose, beam, persons, visit.luck[heard.size()]));
  }
  return heard;
}

void PutPerson(const Visit& visit, Blob& log) {
  std::vector<double> time, x, y;
  for (std::size_t scan = 0; scan < visit.poses.size(); ++scan) {
    const auto at = visit.walker(visit.drive.times_s[scan], visit.poses[scan]);
    if (!at) continue;
    time.push_back(ToMilli(visit.drive.times_s[scan]));
    x.push_back(ToMicro(at->x_m));
    y.push_back(ToMicro(at->y_m));
  }
  log.PutVector("truth/person/time_s", time);
  log.PutVector("truth/person/x_m", x);
  log.PutVector("truth/person/y_m", y);
}

void PutOdometryAndNoise(const Drive& drive, std::uint64_t seed, Blob& log) {
  const OdometryNoise noise = LoopDifficultyOf("base").noise;
  Rng rng(seed, kOdometryStream);
  PutOdometry("robot/0", drive, DrawOdometry(drive, noise, {0, HUGE_VAL, 0}, rng).value(), log);
  PutNoise(noise, log);
  log.PutScalar("noise/sonar_m", kSonarSdM);
}

Blob LogOf(const Visit& visit, std::uint64_t seed) {
  const Hall hall = BuildHall(visit.plan);
  Blob log;
  log.Put("robots", Array::Texts({"robot 0"}));
  PutNoObservations("robot/0", log);
  PutOdometryAndNoise(visit.drive, seed, log);
  PutPoses("robot/0/poses/", visit.drive, log);
  PutPoses("truth/robot/0/poses/", visit.drive, log);
  std::vector<double> ranges;
  std::vector<std::uint8_t> causes;
  for (const Sounding& heard : ListenAll(visit, hall)) {
    ranges.push_back(heard.range_m);
    causes.push_back(static_cast<std::uint8_t>(heard.cause));
  }
  PutScans("robot/0", {}, Milli(visit.drive.times_s), ranges, log);
  log.Put("truth/robot/0/sonar/cause",
          Array::Of<std::uint8_t>({static_cast<std::int64_t>(visit.poses.size()), kSonars}, causes));
  PutHall(hall, log);
  if (visit.walker) PutPerson(visit, log);
  return log;
}

int ThroughDoor(Visit visit, double width_m) {
  visit.plan.doors.front().width_m = width_m;
  const std::vector<Sounding> heard = ListenAll(visit, BuildHall(visit.plan));
  return static_cast<int>(
      std::ranges::count_if(heard, [](const Sounding& s) { return s.cause == Cause::kBeyondDoor; }));
}

// The least width at which `readings` get through, to a tenth of a millimetre: a wider door lets through what
// a narrower one does, and more.
double LeastWidthM(const Visit& visit, int readings) {
  double low = kNarrowestM, high = kWidestM;
  while (high - low > 1e-4) {
    const double middle = (low + high) / 2;
    (ThroughDoor(visit, middle) >= readings ? high : low) = middle;
  }
  return high;
}

// In the middle of the widths that let through as many as asked; none where there is no such width.
std::optional<double> FitWidthM(const Visit& visit, int readings) {
  const double width_m = (LeastWidthM(visit, readings) + LeastWidthM(visit, readings + 1)) / 2;
  if (ThroughDoor(visit, width_m) != readings) return std::nullopt;
  return std::round(width_m * 1e4) / 1e4;
}

}  // namespace

Blob SimulateHallway(const SimulateHallwayOptions& options) {
  if (options.door_readings < 1 || options.door_readings > kMostDoorReadings)
    throw InputError("door readings are " + std::to_string(options.door_readings) + "; allowed is 1 to " +
                     std::to_string(kMostDoorReadings));
  Rng rng(options.seed, kPlanStream);
  HallPlan plan{-2.5, 10.75, rng.Uniform(1.0, 1.2), rng.Uniform(2.3, 2.5), false, {}};
  plan.doors.push_back({rng.Uniform(3.5, 4.7), 1, rng.Uniform(1.8, 2.2), 2, true});
  for (int draw = 0; draw < kMostDraws; ++draw) {
    Visit visit = DrawVisit(plan, 0, 75, 0.11, options.seed, draw);
    const std::optional<double> width_m = FitWidthM(visit, options.door_readings);
    if (!width_m) continue;
    visit.plan.doors.front().width_m = *width_m;
    if (ThroughDoor(visit, *width_m) != options.door_readings) continue;  // the width was rounded
    visit.plan.doors.front().open = !options.closed;
    return LogOf(visit, options.seed);
  }
  throw InputError("no door of this hall lets " + std::to_string(options.door_readings) +
                   " readings through: take another seed");
}

Blob SimulateNarrowDoors(std::uint64_t seed) {
  Rng rng(seed, kPlanStream);
  HallPlan plan{-2.5, 14.5, rng.Uniform(1.2, 1.4), rng.Uniform(2.0, 2.2), false, {}};
  for (const double x : {3.5, 8.5})
    plan.doors.push_back(
        {x + rng.Uniform(-0.5, 0.5), rng.Uniform(0.65, 0.75), rng.Uniform(1.8, 2.2), 2, true});
  Visit visit = DrawVisit(plan, 0, 110, 0.11, seed);
  const double meets_s = rng.Uniform(12, 18), beside_m = -rng.Uniform(0.7, 0.85);
  visit.walker = [plan, meets_s, beside_m](double time_s, const Pose&) -> std::optional<Point> {
    constexpr double kWalkMps = 1;
    const double x = kHallSpeedMps * meets_s - kWalkMps * (time_s - meets_s);
    if (x < plan.from_x_m + kPersonRadiusM || x > plan.to_x_m - kPersonRadiusM) return std::nullopt;
    return Point{x, beside_m};
  };
  return LogOf(visit, seed);
}

Blob SimulateSmoothWall(std::uint64_t seed) {
  Rng rng(seed, kPlanStream);
  HallPlan plan{-2, 50, rng.Uniform(0.9, 1.0), rng.Uniform(1.9, 2.1), true, {}};
  for (double x = 4 + rng.Uniform(0, 2); x < 46; x += rng.Uniform(5, 8))
    plan.doors.push_back({x, rng.Uniform(0.65, 0.8), rng.Uniform(1.8, 3), 2, true});
  Visit visit = DrawVisit(plan, 0, 320, 0.15, seed);
  const double behind_m = rng.Uniform(1.2, 1.5), phase = rng.Uniform(0, 2 * std::numbers::pi);
  visit.walker = [behind_m, phase](double time_s, const Pose& robot) -> std::optional<Point> {
    return Point{robot.x_m - behind_m + 0.15 * std::sin(0.9 * time_s),
                 robot.y_m + 0.35 * std::sin(0.25 * time_s + phase)};
  };
  return LogOf(visit, seed);
}

}  // namespace cairn::datasets
