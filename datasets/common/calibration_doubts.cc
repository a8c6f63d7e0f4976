#include "datasets/common/calibration_doubts.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>

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
  constexpr double kOff = 0.07, kFarOff = 0.15;
  const auto [robot, scale] =
      FindFurthest(map, &kinds::LandmarkMap::Robot::distance_scale, "distance_scale", verdict);
  const Confidence at_most = AtMost(Off(scale), std::log1p(kOff), std::log1p(kFarOff));
  if (at_most == Confidence::kHigh) return {at_most};
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
  constexpr double kFar_m = 0.1;
  const bool far = std::abs(late_s) * MeanSpeed_mps(map.robot[furthest].poses) > kFar_m;
  return {far ? Confidence::kFair : Confidence::kHigh,
          fmt::format("the observations of {} fit better some {:.2g} s {}: are its sensor's clock and its "
                      "odometry's the same? Where it is the sensor's that is off, `cairn import csv "
                      "--sensor-late-s={:.2g}` takes that off",
                      map.robots[furthest], std::abs(late_s), late_s > 0 ? "earlier" : "later", late_s)};
}

// A sensor that is turned on its robot bends the map.
Verdict::Doubt OfTurnedSensors(const kinds::LandmarkMap& map, Verdict* verdict) {
  std::size_t furthest = 0;
  double turned_rad = 0;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    if (std::abs(map.robot[r].bearings_turned_rad.Or(0)) <= std::abs(turned_rad)) continue;
    turned_rad = map.robot[r].bearings_turned_rad.Or(0);
    furthest = r;
  }
  if (turned_rad == 0) return {Confidence::kHigh};
  constexpr double kDegree_rad = std::numbers::pi / 180, kFar_rad = 2 * kDegree_rad;
  verdict->numbers.emplace_back("bearings_turned_rad", turned_rad);
  return {
      std::abs(turned_rad) > kFar_rad ? Confidence::kFair : Confidence::kHigh,
      fmt::format("the bearings of {} fit better some {:.2g} degrees {}: is its sensor turned on the robot? "
                  "`cairn import csv --sensor-mount=0,0,{:.2g}` says so",
                  map.robots[furthest], std::abs(turned_rad) / kDegree_rad,
                  turned_rad > 0 ? "smaller" : "larger", -turned_rad / kDegree_rad)};
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
