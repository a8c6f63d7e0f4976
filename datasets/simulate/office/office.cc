#include "datasets/simulate/office/office.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "datasets/common/control.h"
#include "datasets/simulate/loop.h"
#include "datasets/simulate/odometry.h"
#include "datasets/simulate/office/persons.h"
#include "datasets/simulate/office/plan.h"
#include "datasets/simulate/office/tour.h"
#include "datasets/simulate/rows.h"

namespace cairn::datasets {
namespace {

using office::Office;
using office::Tour;
using office::Walk;

constexpr double kLeastMinutes = 1, kMostMinutes = 120;
constexpr double kSwingRad = 0.8, kSwingRadps = 0.5;  // of the turret, to either side
constexpr double kNeverS = 1e9;
// A control of SimulateLoop, to whose figures the errors of its odometry belong.
constexpr double kLoopStepM = 0.33, kLoopTurnRad = 0.41;

// Streams of the generator.
constexpr std::uint64_t kOfficePlanStream = 0, kOfficeDriveStream = 1, kOfficePersonStream = 2,
                        kOfficeOdometryStream = 3, kMoveStream = 4, kOfficeSonarStream = 5,
                        kInfraredStream = 6;

RangeRing SonarRing() {
  RangeRing ring;
  ring.opening_rad = 0.4363;  // 25 degrees
  ring.max_range_m = 5;
  ring.dropouts = 0.05;
  return ring;
}

RangeRing InfraredRing() {
  return {.sensor = "infrared",
          .sound = false,
          .beams = 16,
          .max_range_m = 0.8,
          .opening_rad = 0,
          .sd_m = 0.02,
          .dropouts = 0.02};
}

// Left and right all the time, whatever the base does.
double TurretRad(double time_s) {
  const double swing = std::fmod(time_s * kSwingRadps / kSwingRad, 4);
  const double share = swing < 1 ? swing : swing < 3 ? 2 - swing : swing - 4;
  return std::round(kSwingRad * share * 1e6) / 1e6;
}

// Same motion, in controls of SimulateLoop's size: `of` says to which of them each control belongs.
Drive Coarse(const Drive& drive, std::vector<std::size_t>* of) {
  Drive coarse;
  coarse.start = drive.start;
  bool turning = false;
  for (const Control& control : drive.controls) {
    const bool turns = control.turn_rad != 0;
    const bool full = coarse.controls.empty() || turns != turning ||
                      coarse.controls.back().forward_m + control.forward_m > kLoopStepM ||
                      std::abs(coarse.controls.back().turn_rad + control.turn_rad) > kLoopTurnRad;
    if (full) coarse.controls.emplace_back();
    turning = turns;
    coarse.controls.back().turn_rad += control.turn_rad;
    coarse.controls.back().forward_m += control.forward_m;
    of->push_back(coarse.controls.size() - 1);
  }
  return coarse;
}

// Errors are drawn for controls as large as those that the figures are of, and spread over the small ones.
OdometryDraw DrawFineOdometry(const Drive& drive, const OdometryNoise& noise, Rng& rng) {
  std::vector<std::size_t> of;
  const Drive coarse = Coarse(drive, &of);
  const OdometryDraw drawn = DrawOdometry(coarse, noise, {0, HUGE_VAL, 0}, rng).value();
  OdometryDraw fine;
  for (std::size_t i = 0; i < of.size(); ++i) {
    const Control &truth = coarse.controls[of[i]], &measured = drawn.controls[of[i]],
                  &now = drive.controls[i];
    Control control;
    if (truth.forward_m > 0) {
      const double share = now.forward_m / truth.forward_m;
      control = {measured.turn_rad * share, measured.forward_m * share};
    } else if (truth.turn_rad != 0) {
      control.turn_rad = measured.turn_rad * now.turn_rad / truth.turn_rad;
    }
    fine.controls.push_back({ToNanoAngle(control.turn_rad), std::round(control.forward_m * 1e9) / 1e9});
  }
  return fine;
}

// The office before and after its furniture moves.
struct Surroundings {
  std::vector<Obstacle> building, before, after;
  double moved_s = kNeverS;

  std::vector<Obstacle> Until(bool moved) const {
    std::vector<Obstacle> all = building;
    const auto& furniture = moved ? after : before;
    all.insert(all.end(), furniture.begin(), furniture.end());
    return all;
  }
};

void PutTurret(const std::string& sensor, const std::vector<double>& times_s, Blob& log) {
  std::vector<double> turret;
  for (const double time_s : times_s) turret.push_back(TurretRad(time_s));
  log.PutVector(sensor + "/turret_rad", turret);
}

// Those that may be heard. The way by a mirror is no shorter than the straight one.
std::vector<Obstacle> Near(const std::vector<Obstacle>& all, const Pose& at, double reach_m) {
  std::vector<Obstacle> near;
  for (const Obstacle& obstacle : all)
    if (DistanceToM(obstacle.wall, {at.x_m, at.y_m}) < reach_m) near.push_back(obstacle);
  return near;
}

void PutRing(const RangeRing& ring, const Surroundings& around, const Tour& tour,
             const std::vector<Walk>& walks, Rng& rng, Blob& log) {
  const std::vector<Obstacle> before = around.Until(false), after = around.Until(true);
  std::vector<double> ranges;
  std::vector<std::uint8_t> causes;
  for (std::size_t scan = 0; scan < tour.poses.size(); ++scan) {
    const double time_s = tour.drive.times_s[scan];
    const std::vector<Point> persons = PersonsAt(walks, time_s);
    Pose pose = tour.poses[scan];
    pose.heading_rad += TurretRad(ToMilli(time_s));
    const std::vector<Obstacle> near =
        Near(time_s < around.moved_s ? before : after, pose, ring.radius_m + ring.max_range_m + 1);
    for (int beam = 0; beam < ring.beams; ++beam) {
      Luck luck = DrawLuck(ring, rng);
      luck.oblique = rng.Uniform();
      const Sounding heard = Listen(near, ring, pose, beam, persons, luck);
      ranges.push_back(heard.range_m);
      causes.push_back(static_cast<std::uint8_t>(heard.cause));
    }
  }
  const std::vector<double> times_s = Milli(tour.drive.times_s);
  PutScans("robot/0", ring, times_s, ranges, log);
  PutTurret("robot/0/" + ring.sensor, times_s, log);
  log.Put("truth/robot/0/" + ring.sensor + "/cause",
          Array::Of<std::uint8_t>({static_cast<std::int64_t>(times_s.size()), ring.beams}, causes));
}

bool Among(const std::vector<Obstacle>& all, const Obstacle& one) {
  return std::ranges::any_of(all, [&](const Obstacle& other) {
    return DistanceM(other.wall.a, one.wall.a) + DistanceM(other.wall.b, one.wall.b) == 0;
  });
}

// Each once, with the time in which it stands.
void PutSurroundings(const Surroundings& around, const Office& office, Blob& log) {
  std::vector<Wall> walls;
  std::vector<std::uint8_t> smooth;
  std::vector<double> from, until;
  const auto add = [&](const Obstacle& obstacle, double from_s, double until_s) {
    walls.push_back(obstacle.wall);
    smooth.push_back(obstacle.surface == Surface::kMirror ? 1 : 0);
    from.push_back(from_s);
    until.push_back(until_s);
  };
  const bool moves = around.moved_s < kNeverS;
  for (const Obstacle& obstacle : around.building) add(obstacle, 0, kNeverS);
  for (const Obstacle& obstacle : around.before)
    add(obstacle, 0, moves && !Among(around.after, obstacle) ? around.moved_s : kNeverS);
  for (const Obstacle& obstacle : around.after)
    if (!Among(around.before, obstacle)) add(obstacle, around.moved_s, kNeverS);
  PutWalls(walls, log);
  log.PutVector("truth/walls/smooth", smooth);
  log.PutVector("truth/walls/from_s", from);
  log.PutVector("truth/walls/until_s", until);
  const std::vector<Wall> doors = DoorsOf(office);
  PutSegments("truth/doors/", doors, log);
  log.PutVector("truth/doors/open", std::vector<std::uint8_t>(doors.size(), 1));
}

void PutPersons(const std::vector<Walk>& walks, const Tour& tour, Blob& log) {
  std::vector<double> time, x, y;
  for (const double time_s : tour.drive.times_s) {
    for (const Point at : PersonsAt(walks, time_s)) {
      time.push_back(ToMilli(time_s));
      x.push_back(ToMicro(at.x_m));
      y.push_back(ToMicro(at.y_m));
    }
  }
  log.PutVector("truth/person/time_s", time);
  log.PutVector("truth/person/x_m", x);
  log.PutVector("truth/person/y_m", y);
}

void PutWallsAbout(const Office& office, const Tour& tour, Blob& log) {
  std::vector<double> angle;
  for (const Pose& pose : tour.poses) angle.push_back(office.WallsRad({pose.x_m, pose.y_m}));
  log.PutVector("truth/robot/0/walls/time_s", Milli(tour.drive.times_s));
  log.PutVector("truth/robot/0/walls/angle_rad", angle);
}

Surroundings SurroundingsOf(const Office& office, const Tour& tour, std::uint64_t seed) {
  Surroundings around{BuildingOf(office), FurnitureOf(office), {}, kNeverS};
  if (tour.moved_s == 0) return around;
  around.moved_s = tour.moved_s;
  Office later = office;
  Rng rng(seed, kMoveStream);
  MoveFurniture(&later, rng);
  around.after = FurnitureOf(later);
  return around;
}

void Check(const SimulateOfficeOptions& options) {
  if (!(options.minutes >= kLeastMinutes && options.minutes <= kMostMinutes))
    throw InputError("minutes are " + std::to_string(options.minutes) + "; allowed is 1 to 120");
}

}  // namespace

Blob SimulateOffice(const SimulateOfficeOptions& options) {
  Check(options);
  Rng plan_rng(options.seed, kOfficePlanStream), drive_rng(options.seed, kOfficeDriveStream),
      person_rng(options.seed, kOfficePersonStream), odometry_rng(options.seed, kOfficeOdometryStream),
      sonar_rng(options.seed, kOfficeSonarStream), infrared_rng(options.seed, kInfraredStream);
  const Office office = office::DrawOffice(options.turned, plan_rng);
  const Tour tour = office::DrawTour(office, options.minutes, options.moved, drive_rng);
  if (options.moved && tour.moved_s == 0)
    throw InputError("moved: in that many minutes the robot is not back in the corridor after half of them");
  const Surroundings around = SurroundingsOf(office, tour, options.seed);
  std::vector<Walk> walks;
  if (options.persons) walks = DrawWalks(office, tour, person_rng);
  Blob log;
  log.Put("robots", Array::Texts({"robot 0"}));
  PutNoObservations("robot/0", log);
  const OdometryNoise noise = LoopDifficultyOf("base").noise;
  PutOdometry("robot/0", tour.drive, DrawFineOdometry(tour.drive, noise, odometry_rng), log);
  PutNoise(noise, log);
  PutRing(SonarRing(), around, tour, walks, sonar_rng, log);
  PutRing(InfraredRing(), around, tour, walks, infrared_rng, log);
  log.PutScalar("noise/sonar_m", kSonarSdM);
  if (options.hints) log.PutVector("robot/0/hints/time_s", Milli(tour.doorways_s));
  PutPoses("truth/robot/0/poses/", tour.drive, log);
  PutWallsAbout(office, tour, log);
  PutSurroundings(around, office, log);
  if (options.persons) PutPersons(walks, tour, log);
  return log;
}

}  // namespace cairn::datasets
