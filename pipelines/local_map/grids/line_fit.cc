#include "pipelines/local_map/grids/line_fit.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {
namespace {

// Of hits about their line, as far as an edge's uncertainty is concerned.
constexpr double kLeastSpreadM = 0.01;

// The frame of a segment: from a, x along it.
struct Along {
  Point a;
  double ux, uy, length_m;

  Along(Point from, Point to) : a(from), length_m(FastDistanceM(from, to)) {
    ux = length_m > 0 ? (to.x_m - from.x_m) / length_m : 1;
    uy = length_m > 0 ? (to.y_m - from.y_m) / length_m : 0;
  }
  double X(Point p) const { return (p.x_m - a.x_m) * ux + (p.y_m - a.y_m) * uy; }
  double Y(Point p) const { return (p.y_m - a.y_m) * ux - (p.x_m - a.x_m) * uy; }
  Point At(double x, double y = 0) const { return {a.x_m + x * ux - y * uy, a.y_m + x * uy + y * ux}; }
  bool Steep() const { return std::abs(uy) > std::abs(ux); }
};

// Whether the cell of a point, or one of those beside it across the segment, is occupied.
bool Supported(const OccupancyGrid& grid, const Along& along, Point at) {
  const std::int32_t i = CellOf(at.x_m, grid.cell_m()), j = CellOf(at.y_m, grid.cell_m());
  if (grid.Occupied(i, j)) return true;
  return along.Steep() ? grid.Occupied(i - 1, j) || grid.Occupied(i + 1, j)
                       : grid.Occupied(i, j - 1) || grid.Occupied(i, j + 1);
}

// How far the segment reaches from its middle (`from_m`) towards `to_m` before a hole, and beyond `to_m`
// while the cells are occupied. `step_m` is negative towards the beginning.
double Reach(const OccupancyGrid& grid, const Along& along, double from_m, double to_m, double step_m,
             double hole_m) {
  const double sign = step_m < 0 ? -1 : 1;
  double last = from_m;
  for (double at = from_m + step_m; sign * (to_m - at) > 0; at += step_m) {
    if (Supported(grid, along, along.At(at))) last = at;
    if (std::abs(at - last) >= hole_m) return last;
  }
  double end = to_m;
  for (double at = to_m + step_m; Supported(grid, along, along.At(at)); at += step_m) end = at;
  return end;
}

// About the barycentre, divided by the number of points.
struct Moments {
  double xx, xy, yy;
  explicit Moments(const LineSums& s)
      : xx((s.xx - s.x * s.x / s.n) / s.n),
        xy((s.xy - s.x * s.y / s.n) / s.n),
        yy((s.yy - s.y * s.y / s.n) / s.n) {}
  // Across the fitted line, the lesser principal moment, and along it.
  double Across() const { return std::max(xx + yy - Apart(), 0.0) / 2; }
  double Along() const { return (xx + yy + Apart()) / 2; }

 private:
  double Apart() const { return std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy); }
};

}  // namespace

double CorrectedAngle(const LineSums& sums) {
  const Moments m(sums);
  // [DM98] figure 1, step 5: tan 2 alpha = 2 sum xy / sum (x^2 - y^2)
  return 0.5 * std::atan2(2 * m.xy, m.xx - m.yy);
}

LineFit::LineFit(const LineFitRule& rule, double cell_m)
    : rule_(rule), hole_m_(std::max(rule.hole_m, 2 * cell_m)) {}

// [DM98] figure 1, step 2: three or more consecutive hits, roughly aligned.
bool LineFit::Aligned(std::span<const Point> hits, std::size_t first, std::size_t last) const {
  const auto at = [&](std::size_t k) { return hits[k % hits.size()]; };
  const Along chord(at(first), at(last));
  const double most = std::min(rule_.unit_m, rule_.bend * chord.length_m);
  double before = 0;
  for (std::size_t k = first + 1; k <= last; ++k) {
    const double x = chord.X(at(k));
    if (x <= before || x - before > rule_.gap_m || std::abs(chord.Y(at(k))) > most) return false;
    before = x;
  }
  return true;
}

// [DM98] figure 1, step 3
void LineFit::Enhance(const OccupancyGrid& grid, Segment* segment) const {
  const Along along(segment->a, segment->b);
  const double middle = along.length_m / 2, step = grid.cell_m();
  const double end = Reach(grid, along, middle, along.length_m, step, hole_m_);
  const double begin = Reach(grid, along, middle, 0, -step, hole_m_);
  *segment = {along.At(begin), along.At(end)};
}

// [DM98] figure 1, steps 4 and 5
bool LineFit::Fit(const OccupancyGrid& grid, const Segment& segment, Edge* edge) const {
  const Along along(segment.a, segment.b);
  LineSums sums;
  double first = 0, furthest = 0, hole = 0;
  const auto gather = [&](Point hit) {
    const double x = along.X(hit), y = along.Y(hit);
    if (std::abs(y) > rule_.unit_m || x < -rule_.unit_m || x > along.length_m + rule_.unit_m) return;
    hole = sums.n == 0 ? 0 : std::max(hole, x - furthest);
    first = sums.n == 0 ? x : std::min(first, x);
    furthest = sums.n == 0 ? x : std::max(furthest, x);
    sums.Add(x, y);
  };
  // Column by column (row by row) in the segment's direction, so that hits come in about their order along
  // it.
  const bool steep = along.Steep();
  const double cell = grid.cell_m();
  const auto begin = steep ? CellOf(segment.a.y_m, cell) : CellOf(segment.a.x_m, cell);
  const auto end = steep ? CellOf(segment.b.y_m, cell) : CellOf(segment.b.x_m, cell);
  const std::int32_t step = end >= begin ? 1 : -1;
  const double slope = steep ? along.ux / along.uy : along.uy / along.ux;
  for (std::int32_t k = begin - step; k != end + 2 * step; k += step) {
    const double beside = steep ? segment.a.x_m + slope * (k * cell - segment.a.y_m)
                                : segment.a.y_m + slope * (k * cell - segment.a.x_m);
    const std::int32_t l = CellOf(beside, cell);
    if (steep)
      grid.ForOccupied({l - 2, k}, {l + 2, k}, gather);
    else
      grid.ForOccupied({k, l - 2}, {k, l + 2}, gather);
  }
  if (sums.n < rule_.min_hits || hole > hole_m_ || furthest - first < rule_.min_length_m) return false;
  const Moments moments(sums);
  if (moments.Across() > rule_.spread_m * rule_.spread_m) return false;
  const double turn = CorrectedAngle(sums);
  if (std::abs(turn) > rule_.max_turn_rad) return false;
  const double x = sums.x / sums.n, y = sums.y / sums.n;
  const double c = std::cos(turn), s = std::sin(turn);
  edge->a = along.At(x + (first - x) * c, y + (first - x) * s);
  edge->b = along.At(x + (furthest - x) * c, y + (furthest - x) * s);
  edge->angle_rad = ModuloAngle(std::atan2(along.uy, along.ux) + turn, std::numbers::pi);
  edge->sd_rad = std::sqrt((moments.Across() + kLeastSpreadM * kLeastSpreadM) / (sums.n * moments.Along()));
  edge->hits = static_cast<int>(sums.n);
  return true;
}

bool LineFit::Known(const Segment& segment, std::span<const Edge> edges) const {
  for (const Edge& edge : edges) {
    const Along along(edge.a, edge.b);
    const auto on = [&](Point p) {
      return std::abs(along.Y(p)) <= rule_.unit_m && along.X(p) >= -rule_.unit_m &&
             along.X(p) <= along.length_m + rule_.unit_m;
    };
    if (on(segment.a) && on(segment.b)) return true;
  }
  return false;
}

void LineFit::Find(std::span<const Point> hits, bool closed, const OccupancyGrid& grid,
                   std::vector<Edge>* edges) const {
  const std::size_t n = hits.size();
  if (n < 3) return;
  const std::size_t starts = closed ? n : n - 2, most = closed ? n : 0;
  for (std::size_t first = 0; first < starts;) {
    std::size_t last = first + 1;
    while (last + 1 < first + n && last + 1 < n + most && Aligned(hits, first, last + 1)) ++last;
    if (last < first + 2) {
      ++first;
      continue;
    }
    Segment segment{hits[first], hits[last % n]};
    first = last;  // a corner belongs to both walls
    if (Known(segment, *edges)) continue;
    Enhance(grid, &segment);
    Edge edge;
    if (edges->size() < edges->capacity() && Fit(grid, segment, &edge)) edges->push_back(edge);
  }
}

}  // namespace cairn::local_map
