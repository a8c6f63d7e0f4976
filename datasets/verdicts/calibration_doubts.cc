#include "datasets/verdicts/calibration_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>

#include "schema/geometry.h"
#include "schema/middle.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

// By how much a scale is off: of one as many times too large as too small.
double Off(double scale) { return std::abs(std::log(scale)); }

// Of the robot whose scale is furthest off; 1 where none has any.
struct FurthestScale {
  std::string robot;
  double scale = 1;
};

FurthestScale FindFurthest(const kinds::LandmarkMap& map, Column<double> kinds::LandmarkMap::Robot::* scale,
                           const char* name, Verdict* verdict) {
  FurthestScale furthest;
  bool any = false;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const double of_robot = (map.robot[r].*scale).Or(1);
    any |= static_cast<bool>(map.robot[r].*scale);
    if (Off(of_robot) > Off(furthest.scale)) furthest = {map.robots[r], of_robot};
  }
  if (any) verdict->numbers.emplace_back(name, furthest.scale);
  return furthest;
}

// Its way over all of its time.
double MeanSpeed_mps(const kinds::LandmarkMap::RobotPoses& poses) {
  const std::span<const double> time = poses.time_s.OrNone(), x = poses.x_m.OrNone(), y = poses.y_m.OrNone();
  double way_m = 0;
  for (std::size_t i = 1; i < x.size(); ++i) way_m += std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
  return way_m > 0 ? way_m / (time.back() - time.front()) : 0;
}

}  // namespace

// Where odometry's distances are not those of the ranges, either may be the one that is wrong, and the map
// has the ranges' scale.
Verdict::Doubt OfDistances(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kSaid = 0.02, kOff = 0.07, kFarOff = 0.15;
  const auto [robot, scale] =
      FindFurthest(map, &kinds::LandmarkMap::Robot::distance_scale, "distance_scale", verdict);
  const Confidence at_most = AtMost(Off(scale), std::log1p(kOff), std::log1p(kFarOff));
  if (Off(scale) <= std::log1p(kSaid)) return {at_most};
  if (at_most == Confidence::kHigh)
    return {at_most,
            fmt::format("{} has travelled {:.2f} times as far by its ranges as by its odometry; the map "
                        "has the scale of the ranges, and takes it for exact",
                        robot, scale)};
  return {at_most,
          fmt::format("{} has travelled {:.2f} times as far by its ranges as by its odometry: are both in "
                      "metres and calibrated? The map has the scale of the ranges",
                      robot, scale)};
}

// What was found and taken off makes no map worse; but who made the log may want to mend it.
Verdict::Doubt OfRangeOffsets(const kinds::LandmarkMap& map, Verdict* verdict) {
  std::string robot;
  double furthest_m = 0;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const double offset_m = map.robot[r].range_offset_m.Or(0);
    if (std::abs(offset_m) <= std::abs(furthest_m)) continue;
    robot = map.robots[r];
    furthest_m = offset_m;
  }
  if (furthest_m == 0) return {Confidence::kHigh};
  verdict->numbers.emplace_back("range_offset_m", furthest_m);
  // Of several robots a factor on the ranges of one shows as offsets of both.
  return {map.robot.size() > 1 ? Confidence::kFair : Confidence::kHigh,
          fmt::format("the ranges of {} are {:.2f} m too {}, which was taken off", robot,
                      std::abs(furthest_m), furthest_m > 0 ? "long" : "short")};
}

// How exact the path says it is, the middle of its standard deviations along an axis; 0: it does not say.
double PathSd_m(const kinds::LandmarkMap::RobotPoses& poses) {
  const std::span<const double> covariance = poses.covariance.OrNone();
  return MiddleOf([&](const auto& take) {
           for (std::size_t i = 0; i + 9 <= covariance.size(); i += 9)
             take(std::sqrt(std::max(0.0, 0.5 * (covariance[i] + covariance[i + 4]))));
         })
      .value_or(0);
}

// What takes it off, of one robot, which is named where there are several.
std::string Option(const kinds::LandmarkMap& map, std::size_t robot, const char* option,
                   const std::string& value) {
  const std::string whose = map.robot.size() > 1 ? ShellWord(map.robots[robot] + "=") : "";
  return fmt::format(" `cairn import csv {}={}{}` takes that off (added to what it was told before)", option,
                     whose, value);
}

// The map hardly suffers, but the robot was not there when the path says so.
Verdict::Doubt OfClocks(const kinds::LandmarkMap& map, Verdict* verdict) {
  std::size_t furthest = 0;
  double late_s = 0;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    if (std::abs(map.robot[r].observations_late_s.Or(0)) <= std::abs(late_s)) continue;
    late_s = map.robot[r].observations_late_s.Or(0);
    furthest = r;
  }
  if (late_s == 0) return {Confidence::kHigh};
  verdict->numbers.emplace_back("observations_late_s", late_s);
  constexpr double kFar_m = 0.1, k95 = 2.448;  // of a Gaussian in the plane
  const double off_m = std::abs(late_s) * MeanSpeed_mps(map.robot[furthest].poses);
  if (off_m <= kFar_m) return {Confidence::kHigh};
  const double sd_m = PathSd_m(map.robot[furthest].poses);
  return {sd_m > 0 && off_m > k95 * sd_m ? Confidence::kLow : Confidence::kFair,
          fmt::format("the observations of {} fit better some {:.2g} s {}: are its sensor's clock and its "
                      "odometry's the same? Else its path is {:.2g} m off along its way. If the sensor's is "
                      "off:{}",
                      map.robots[furthest], std::abs(late_s), late_s > 0 ? "earlier" : "later", off_m,
                      Option(map, furthest, "--sensor-late-s", fmt::format("{:.2g}", late_s)))};
}

constexpr double kFarMount_m = 0.1, kFarMount_rad = 2 * std::numbers::pi / 180;

// 1: so far that it is said.
double Far(const Pose& mount) {
  return std::max(std::hypot(mount.x_m, mount.y_m) / kFarMount_m,
                  std::abs(mount.heading_rad) / kFarMount_rad);
}

// Of a robot that turns while it goes, whose odometry is read as first the turn, then the way, the sensor
// seems to sit half a step behind where it is.
struct StepsInstead {
  std::string text;  // empty: steps are too short
  bool explain_all = false;
};

StepsInstead LookAtSteps(const kinds::LandmarkMap::Robot& robot, const Pose& mount) {
  constexpr double kLeast_m = 0.03;
  const double half_m = robot.half_step_m.Or(0);
  if (std::abs(half_m) < kLeast_m || (mount.x_m == 0 && mount.y_m == 0)) return {};
  const bool explain_all = Far({mount.x_m + half_m, mount.y_m, mount.heading_rad}) <= 1;
  return {fmt::format(
              " Its odometry turns and goes in one row, and half of such a step is {:.2f} m: if the "
              "robot turned along the way, and not before it, `cairn import csv --steps-are-arcs` {}",
              std::abs(half_m),
              explain_all ? "takes that off" : "comes first, and what is then left is the sensor's. If not:"),
          explain_all};
}

// A sensor that sits elsewhere than it is taken to, or is turned, bends the map.
Verdict::Doubt OfMounts(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kDegree_rad = std::numbers::pi / 180;
  std::size_t furthest = 0;
  Pose mount;
  double most = 0;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const kinds::LandmarkMap::Robot& of = map.robot[r];
    const Pose at{of.sensor_x_m.Or(0), of.sensor_y_m.Or(0), -of.bearings_turned_rad.Or(0)};
    if (Far(at) <= most) continue;
    most = Far(at);
    mount = at;
    furthest = r;
  }
  if (most == 0) return {Confidence::kHigh};
  verdict->numbers.emplace_back("bearings_turned_rad", -mount.heading_rad);
  verdict->numbers.emplace_back("sensor_x_m", mount.x_m);
  verdict->numbers.emplace_back("sensor_y_m", mount.y_m);
  if (most <= 1) return {Confidence::kHigh};
  const double degrees = mount.heading_rad / kDegree_rad;
  const std::string what =
      mount.x_m == 0 && mount.y_m == 0
          ? fmt::format(
                "the bearings of {} fit better some {:.2g} degrees {}: is its sensor turned on the robot?",
                map.robots[furthest], std::abs(degrees), degrees > 0 ? "larger" : "smaller")
          : fmt::format(
                "the observations of {} fit better from a sensor that sits {:.2f} m {} and {:.2f} m to the "
                "{} "
                "of where the robot turns about, turned by {:.1f} degrees: does it?",
                map.robots[furthest], std::abs(mount.x_m), mount.x_m < 0 ? "behind" : "ahead",
                std::abs(mount.y_m), mount.y_m < 0 ? "right" : "left", degrees);
  const char* or_else =
      map.robot[furthest].observations_late_s.Or(0) != 0
          ? "; that explains as much as its clock does, take off the one that you know to be off:"
          : "";
  const StepsInstead steps = LookAtSteps(map.robot[furthest], mount);
  const std::string option =
      or_else + Option(map, furthest, "--sensor-mount",
                       fmt::format("{:.2f},{:.2f},{:.2g}", mount.x_m, mount.y_m, degrees));
  return {Confidence::kFair, what + steps.text + (steps.explain_all ? "" : option)};
}

// Turns the observations tell well, whatever odometry says: MRCLAM's robots turn three quarters as far as
// theirs, and are mapped well.
Verdict::Doubt OfTurns(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kOff = 0.15;
  const auto [robot, scale] =
      FindFurthest(map, &kinds::LandmarkMap::Robot::turn_scale, "turn_scale", verdict);
  if (Off(scale) <= std::log1p(kOff)) return {Confidence::kHigh};
  return {
      Confidence::kFair,
      fmt::format("{} has turned {:.2f} times as far by its observations as by its odometry", robot, scale)};
}

}  // namespace cairn::datasets
