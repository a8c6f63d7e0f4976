#include "datasets/simulate/corridor/run.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn::datasets::corridor {
namespace {

constexpr double kDeg = std::numbers::pi / 180;
constexpr double kLampFails = 0.06;       // share of the lamps that are off
constexpr double kMeetingSpacingM = 6;    // of people who walk, along the robot's way
constexpr double kStandingSpacingM = 25;  // of those who stand and talk
constexpr double kWanderM = 0.10,
                 kWanderAlongM = 4;  // to either side of the middle, sd; correlated along so much
constexpr double kYawRad = 2.5 * kDeg, kYawAlongM = 0.8;
constexpr double kLargestOffsetM = 0.65;

// An Ornstein-Uhlenbeck process: standard deviation `sd`, correlation e^-1 after `along_m`.
class Wander {
 public:
  Wander(double sd, double along_m, Rng& rng) : sd_(sd), along_m_(along_m), value_(sd * rng.Normal()) {}
  double After(double distance_m, Rng& rng) {
    const double keep = std::exp(-distance_m / along_m_);
    value_ = keep * value_ + sd_ * std::sqrt(1 - keep * keep) * rng.Normal();
    return value_;
  }

 private:
  double sd_, along_m_, value_;
};

Person DrawPerson(double y_m, Rng& rng) {
  Person person;
  person.y_m = y_m;
  person.height_m = rng.Uniform(1.55, 1.9);
  person.shirt = {rng.Uniform(0.08, 0.9), rng.Uniform(0.08, 0.9), rng.Uniform(0.08, 0.9)};
  person.trousers = {rng.Uniform(0.05, 0.35), rng.Uniform(0.05, 0.35), rng.Uniform(0.1, 0.45)};
  const double skin = rng.Uniform(0.35, 0.85);
  person.skin = {skin, 0.75 * skin, 0.6 * skin};
  return person;
}

// Where the robot makes way, and to which side.
struct Swerve {
  double x_m = 0, offset_m = 0, width_m = 1;
};

double SideDraw(Rng& rng) { return rng.Uniform() < 0.5 ? 1 : -1; }

Swerve AwayFrom(double x_m, double y_m, Rng& rng) {
  return {x_m, (y_m > 0 ? -1 : 1) * rng.Uniform(0.1, 0.45), rng.Uniform(0.7, 1.3)};
}

void DrawPeople(double length_m, Run* run, std::vector<Swerve>* swerves, Rng& rng) {
  const auto gap = [&](double spacing_m) { return -spacing_m * std::log(1 - rng.Uniform()); };
  for (double x = gap(kMeetingSpacingM); x < length_m; x += gap(kMeetingSpacingM)) {
    Person person = DrawPerson(SideDraw(rng) * rng.Uniform(0.65, 1.05), rng);
    const double pace = rng.Uniform() < 0.25 ? rng.Uniform(0.3, 0.6) : rng.Uniform(0.9, 1.5);
    person.speed_mps = SideDraw(rng) * pace;
    person.x_m = x - person.speed_mps * x / kSpeedMps;  // so that they meet at x
    run->people.push_back(person);
    if (rng.Uniform() < 0.6) swerves->push_back(AwayFrom(x, person.y_m, rng));
  }
  for (double x = gap(kStandingSpacingM); x < length_m; x += gap(kStandingSpacingM)) {
    Person person = DrawPerson(SideDraw(rng) * rng.Uniform(0.85, 1.15), rng);
    person.x_m = x;
    run->people.push_back(person);
    swerves->push_back(AwayFrom(x, person.y_m, rng));
  }
}

// Offset from the middle, and its slope.
struct Offset {
  double y_m = 0, slope = 0;
};

Offset SwerveAt(double x_m, const std::vector<Swerve>& swerves) {
  Offset sum;
  for (const Swerve& s : swerves) {
    const double u = (x_m - s.x_m) / s.width_m;
    const double y = s.offset_m * std::exp(-u * u);
    sum.y_m += y;
    sum.slope += -2 * u / s.width_m * y;
  }
  return sum;
}

void Drive(double length_m, int snapshots, const std::vector<Swerve>& swerves, Run* run, Rng& rng) {
  const double step_m = length_m / (snapshots - 1);
  Wander wander(kWanderM, kWanderAlongM, rng), yaw(kYawRad, kYawAlongM, rng);
  double last = wander.After(0, rng);
  for (int k = 0; k < snapshots; ++k) {
    const double x = step_m * k, drift = wander.After(step_m, rng);
    const Offset swerve = SwerveAt(x, swerves);
    const double y = std::clamp(drift + swerve.y_m, -kLargestOffsetM, kLargestOffsetM);
    // Small wandering is side-slip of a path that is already smooth; the swerves turn the robot.
    const double heading = std::atan(swerve.slope + 0.3 * (drift - last) / step_m) + yaw.After(step_m, rng);
    run->snapshots.push_back({x / kSpeedMps, {x, y, WrapAngle(heading)}});
    last = drift;
  }
}

// What was drawn for a drive from the near end, seen from the far one.
void TurnRound(double length_m, Run* run) {
  for (Snapshot& snapshot : run->snapshots) {
    const Pose pose = snapshot.pose;
    snapshot.pose = {length_m - pose.x_m, -pose.y_m, WrapAngle(pose.heading_rad + std::numbers::pi)};
  }
  for (Person& person : run->people) {
    person.x_m = length_m - person.x_m;
    person.y_m = -person.y_m;
    person.speed_mps = -person.speed_mps;
  }
}

}  // namespace

Run DrawRun(const World& world, int snapshots, bool back, Rng& rng) {
  Run run;
  for (const Side side : {kOuter, kInner}) {
    for (const Opening& opening : world.walls[side].openings)
      run.open[side].push_back(rng.Uniform() < opening.open_ratio);
  }
  for (std::size_t i = 0; i < world.lamps.size(); ++i) run.lamp_on.push_back(rng.Uniform() > kLampFails);
  run.bins = world.bins;
  for (Bin& bin : run.bins) bin.x_m += 0.12 * rng.Normal();
  run.brightness = rng.Uniform(0.85, 1.15);
  run.daylight = rng.Uniform(0.05, 1.6);
  run.noise = rng.Uniform(0.012, 0.028);
  run.white = {1 + 0.03 * rng.Normal(), 1, 1 + 0.03 * rng.Normal()};
  std::vector<Swerve> swerves;
  DrawPeople(world.length_m, &run, &swerves, rng);
  Drive(world.length_m, snapshots, swerves, &run, rng);
  if (back) TurnRound(world.length_m, &run);
  return run;
}

}  // namespace cairn::datasets::corridor
