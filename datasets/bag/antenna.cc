#include "datasets/bag/antenna.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "schema/square.h"

namespace cairn::datasets::bag {
namespace {

// A fix with odometry at its time, in odometry's frame.
struct PlacedFix {
  PoseRow fix;
  Pose robot, antenna;
  double way_m = 0;  // of the antenna
};

class OdometryAt {
 public:
  explicit OdometryAt(const SpooledRows<PoseRow>& rows) : rows_(rows) {}
  // Times in order.
  std::optional<Pose> At(double time_s) {
    constexpr double kMostGap_s = 1;
    while (next_ < rows_.size() && rows_[next_].time_s < time_s) ++next_;
    if (next_ == rows_.size()) return std::nullopt;
    const PoseRow& to = rows_[next_];
    if (to.time_s == time_s) return to.pose;
    if (next_ == 0) return std::nullopt;
    const PoseRow& from = rows_[next_ - 1];
    const double length_s = to.time_s - from.time_s;
    if (length_s > kMostGap_s) return std::nullopt;
    return Interpolate(from.pose, to.pose, (time_s - from.time_s) / length_s);
  }

 private:
  const SpooledRows<PoseRow>& rows_;
  std::size_t next_ = 0;
};

std::vector<PlacedFix> PlaceFixes(const Pose& antenna, const SpooledRows<PoseRow>& odometry,
                                  const std::vector<PoseRow>& fixes) {
  OdometryAt at(odometry);
  std::vector<PlacedFix> placed;
  for (const PoseRow& fix : fixes) {
    const std::optional<Pose> robot = at.At(fix.time_s);
    if (!robot) continue;
    placed.push_back({fix, *robot, Compose(*robot, antenna), 0});
    if (placed.size() == 1) continue;
    const PlacedFix& before = placed[placed.size() - 2];
    placed.back().way_m = before.way_m + DistanceM({before.antenna.x_m, before.antenna.y_m},
                                                   {placed.back().antenna.x_m, placed.back().antenna.y_m});
  }
  return placed;
}

// The turn that lays the antenna's way by odometry, of whatever metre, on the fixes [first, last] of
// `stations`; nothing where the robot hardly moves or they do not fit.
std::optional<double> FitTurn(const std::vector<PlacedFix>& stations, std::size_t first, std::size_t last) {
  constexpr double kLeast_m = 0.3, kMostOff = 0.3;
  constexpr std::size_t kFew = 4;
  const std::size_t count = last - first + 1;
  if (count < kFew) return std::nullopt;
  Point by_odometry, by_fixes;  // on average
  for (std::size_t i = first; i <= last; ++i) {
    const double share = 1 / static_cast<double>(count);
    by_odometry.x_m += share * stations[i].antenna.x_m;
    by_odometry.y_m += share * stations[i].antenna.y_m;
    by_fixes.x_m += share * stations[i].fix.pose.x_m;
    by_fixes.y_m += share * stations[i].fix.pose.y_m;
  }
  double along = 0, across = 0, odometry2 = 0, fixes2 = 0;
  for (std::size_t i = first; i <= last; ++i) {
    const double x = stations[i].antenna.x_m - by_odometry.x_m, y = stations[i].antenna.y_m - by_odometry.y_m;
    const double u = stations[i].fix.pose.x_m - by_fixes.x_m, v = stations[i].fix.pose.y_m - by_fixes.y_m;
    along += x * u + y * v;
    across += x * v - y * u;
    odometry2 += x * x + y * y;
    fixes2 += u * u + v * v;
  }
  const double least2 = Square(kLeast_m) * static_cast<double>(count);
  if (odometry2 < least2 || fixes2 < least2) return std::nullopt;
  const double left2 = fixes2 - (Square(along) + Square(across)) / odometry2;
  if (left2 > Square(kMostOff) * fixes2) return std::nullopt;
  return std::atan2(across, along);
}

// Those between which the antenna moves: where the robot stands, many fixes tell no more.
std::vector<PlacedFix> StationsOf(const std::vector<PlacedFix>& placed) {
  constexpr double kApart_m = 0.1;
  std::vector<PlacedFix> stations;
  for (const PlacedFix& fix : placed)
    if (stations.empty() || fix.way_m - stations.back().way_m >= kApart_m) stations.push_back(fix);
  return stations;
}

}  // namespace

std::size_t TakeOffAntenna(const Pose& antenna, const SpooledRows<PoseRow>& odometry,
                           std::vector<PoseRow>* fixes) {
  constexpr double kAround_m = 5;
  const std::vector<PlacedFix> placed = PlaceFixes(antenna, odometry, *fixes);
  const std::vector<PlacedFix> stations = StationsOf(placed);
  std::vector<PoseRow> robot;
  for (std::size_t i = 0, first = 0, end = 0; i < placed.size(); ++i) {
    while (stations[first].way_m < placed[i].way_m - kAround_m) ++first;
    while (end < stations.size() && stations[end].way_m <= placed[i].way_m + kAround_m) ++end;
    const std::optional<double> turn = FitTurn(stations, first, end - 1);
    if (!turn) continue;
    PoseRow row = placed[i].fix;
    row.pose.heading_rad = WrapAngle(placed[i].robot.heading_rad + *turn);
    const Pose on_robot = Compose({0, 0, row.pose.heading_rad}, antenna);
    row.pose.x_m -= on_robot.x_m;
    row.pose.y_m -= on_robot.y_m;
    robot.push_back(row);
  }
  const std::size_t left_out = fixes->size() - robot.size();
  *fixes = std::move(robot);
  return left_out;
}

}  // namespace cairn::datasets::bag
