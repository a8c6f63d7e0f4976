#include "datasets/evaluate/matching/similarity.h"

#include <cmath>
#include <limits>

namespace cairn::datasets {
namespace {

struct Moments {
  Point from, to;          // means
  double dot = 0;          // sum of <from, to> about the means
  double cross = 0;        // sum of from x to
  double from_square = 0;  // sum of |from|^2
};

Moments MomentsOf(const std::vector<PointPair>& pairs) {
  Moments m;
  const auto n = static_cast<double>(pairs.size());
  for (const PointPair& pair : pairs) {
    m.from.x_m += pair.from.x_m / n;
    m.from.y_m += pair.from.y_m / n;
    m.to.x_m += pair.to.x_m / n;
    m.to.y_m += pair.to.y_m / n;
  }
  for (const PointPair& pair : pairs) {
    const double ax = pair.from.x_m - m.from.x_m, ay = pair.from.y_m - m.from.y_m;
    const double bx = pair.to.x_m - m.to.x_m, by = pair.to.y_m - m.to.y_m;
    m.dot += ax * bx + ay * by;
    m.cross += ax * by - ay * bx;
    m.from_square += ax * ax + ay * ay;
  }
  return m;
}

// In the plane the singular value decomposition of Umeyama's eq. 40 is one angle: that of (dot, cross).
Similarity Fit(const std::vector<PointPair>& pairs, bool with_scale) {
  if (pairs.empty()) return {};
  const Moments m = MomentsOf(pairs);
  Similarity fit;
  const double size = std::hypot(m.dot, m.cross);
  if (size > 0) fit.angle_rad = std::atan2(m.cross, m.dot);
  if (with_scale && size > 0) fit.scale = size / m.from_square;
  const Point turned = fit(m.from);
  fit.x_m = m.to.x_m - turned.x_m;
  fit.y_m = m.to.y_m - turned.y_m;
  return fit;
}

}  // namespace

Point Similarity::operator()(Point from) const {
  const double c = scale * std::cos(angle_rad), s = scale * std::sin(angle_rad);
  return {c * from.x_m - s * from.y_m + x_m, s * from.x_m + c * from.y_m + y_m};
}

Pose Similarity::operator()(const Pose& from) const {
  const Point at = (*this)(Point{from.x_m, from.y_m});
  return {at.x_m, at.y_m, WrapAngle(from.heading_rad + angle_rad)};
}

Similarity FitRigid(const std::vector<PointPair>& pairs) { return Fit(pairs, false); }

Similarity FitSimilarity(const std::vector<PointPair>& pairs) { return Fit(pairs, true); }

Similarity Inverse(const Similarity& there) {
  Similarity back{1 / there.scale, -there.angle_rad, 0, 0};
  const Point origin = back(Point{there.x_m, there.y_m});
  back.x_m = -origin.x_m;
  back.y_m = -origin.y_m;
  return back;
}

double RmseM(const std::vector<PointPair>& pairs, const Similarity& transform) {
  if (pairs.empty()) return std::numeric_limits<double>::quiet_NaN();
  double squares = 0;
  for (const PointPair& pair : pairs) {
    const double distance = DistanceM(transform(pair.from), pair.to);
    squares += distance * distance;
  }
  return std::sqrt(squares / static_cast<double>(pairs.size()));
}

}  // namespace cairn::datasets
