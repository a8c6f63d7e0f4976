#include "datasets/report/drawing/course.h"

#include <algorithm>
#include <utility>

namespace cairn::datasets::report {
namespace {

Point Between(Point a, Point b, double share) {
  return {a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m)};
}

// Where the foot of p's perpendicular lies on the way from a to b, in [0, 1].
double ShareOf(Point p, Point a, Point b) {
  const double x = b.x_m - a.x_m, y = b.y_m - a.y_m, square = x * x + y * y;
  return square > 0 ? std::clamp(((p.x_m - a.x_m) * x + (p.y_m - a.y_m) * y) / square, 0.0, 1.0) : 0;
}

}  // namespace

std::vector<std::size_t> CourseOf(std::span<const Point> points, std::span<const double> times_s,
                                  double tolerance) {
  if (points.empty()) return {};
  std::vector<bool> kept(points.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> stretches{{0, points.size() - 1}};
  while (!stretches.empty()) {
    const auto [first, last] = stretches.back();
    stretches.pop_back();
    double farthest = tolerance;
    std::size_t split = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const Point a = points[first], b = points[last];
      double share = 0;
      if (times_s.empty())
        share = ShareOf(points[i], a, b);
      else if (times_s[last] > times_s[first])
        share = (times_s[i] - times_s[first]) / (times_s[last] - times_s[first]);
      if (const double off = DistanceM(points[i], Between(a, b, share)); off > farthest) {
        farthest = off;
        split = i;
      }
    }
    if (split == first) continue;
    kept[split] = true;
    stretches.emplace_back(first, split);
    stretches.emplace_back(split, last);
  }
  std::vector<std::size_t> course;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (kept[i]) course.push_back(i);
  return course;
}

}  // namespace cairn::datasets::report
