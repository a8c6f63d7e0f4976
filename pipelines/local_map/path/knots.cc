#include "pipelines/local_map/path/knots.h"

#include <cmath>

namespace cairn::local_map {

std::vector<std::size_t> KnotsOf(const std::vector<Sweep>& sweeps, const KnotOptions& options) {
  std::vector<std::size_t> knots;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    if (knots.empty() || sweeps[s].run != sweeps[s - 1].run || s + 1 == sweeps.size() ||
        sweeps[s].path_m - sweeps[knots.back()].path_m >= options.apart_m)
      knots.push_back(s);
  }
  return knots;
}

std::vector<Leg> LegsOf(const std::vector<Sweep>& sweeps, const std::vector<std::size_t>& knots,
                        std::int32_t first, const KnotOptions& options) {
  constexpr double kLeast_m = 0.005;
  std::vector<Leg> legs;
  for (std::size_t k = 1; k < knots.size(); ++k) {
    const Sweep &from = sweeps[knots[k - 1]], &to = sweeps[knots[k]];
    Leg leg;
    leg.from = first + static_cast<std::int32_t>(k) - 1;
    leg.to = leg.from + 1;
    leg.way = {to.pose.x_m - from.pose.x_m, to.pose.y_m - from.pose.y_m};
    const double root = std::sqrt(to.path_m - from.path_m);
    const bool cut = to.run != from.run;
    const double more = !cut ? 0 : to.jumped ? options.jump_m : options.gap_m;
    leg.along_m = std::hypot(options.along_sd * root, kLeast_m, more);
    leg.across_m = std::hypot(options.across_sd * root, kLeast_m, more);
    legs.push_back(leg);
  }
  return legs;
}

void MoveTo(const std::vector<std::size_t>& knots, const Point* placed, std::vector<Sweep>* sweeps) {
  const std::vector<Sweep> before = *sweeps;
  const auto moved = [&](std::size_t k) {
    const Pose& pose = before[knots[k]].pose;
    return Point{placed[k].x_m - pose.x_m, placed[k].y_m - pose.y_m};
  };
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const bool last = k + 1 == knots.size();
    const std::size_t end = last ? before.size() : knots[k + 1];
    const Point here = moved(k), there = last ? here : moved(k + 1);
    const double way_m = last ? 0 : before[knots[k + 1]].path_m - before[knots[k]].path_m;
    const bool cut = !last && before[knots[k + 1]].run != before[knots[k]].run;
    for (std::size_t s = knots[k]; s < end; ++s) {
      const double part = way_m > 0 && !cut ? (before[s].path_m - before[knots[k]].path_m) / way_m : 0;
      (*sweeps)[s].pose.x_m += here.x_m + part * (there.x_m - here.x_m);
      (*sweeps)[s].pose.y_m += here.y_m + part * (there.y_m - here.y_m);
    }
  }
}

}  // namespace cairn::local_map
