#include "pipelines/local_map/straight_runs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn::local_map {
namespace {

constexpr double kQuarter_rad = std::numbers::pi / 2;

double AlongM(const Pose& from, const Pose& to, int quarter) {
  const double dx = to.x_m - from.x_m, dy = to.y_m - from.y_m;
  return quarter == 0 ? dx : quarter == 1 ? dy : quarter == 2 ? -dx : -dy;
}

bool IsAlong(const Pose& pose, int quarter, double tolerance_rad) {
  return std::abs(Wrapped(pose.heading_rad - quarter * kQuarter_rad)) <= tolerance_rad;
}

}  // namespace

int QuarterOf(double heading_rad) {
  const auto quarter = static_cast<int>(std::lround(Wrapped(heading_rad) / kQuarter_rad));
  return (quarter + 4) % 4;
}

std::vector<StraightRun> StraightRunsOf(const std::vector<Pose>& poses, std::size_t first, std::size_t end,
                                        const std::vector<std::size_t>& hints,
                                        const StraightRunOptions& options) {
  std::vector<StraightRun> runs;
  std::size_t begin = first;
  while (begin < end) {
    const int quarter = QuarterOf(poses[begin].heading_rad);
    std::size_t last = begin + 1;
    while (last < end && IsAlong(poses[last], quarter, options.direction_rad) &&
           !std::ranges::binary_search(hints, last) &&
           AlongM(poses[begin], poses[last], quarter) <= options.most_m) {
      ++last;
    }
    if (AlongM(poses[begin], poses[last - 1], quarter) >= options.least_m) {
      runs.push_back({begin, last, quarter});
    }
    begin = last;
  }
  return runs;
}

}  // namespace cairn::local_map
