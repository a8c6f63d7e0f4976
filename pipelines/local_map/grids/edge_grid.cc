#include "pipelines/local_map/grids/edge_grid.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {

EdgeGrid::EdgeGrid(double cell_m, int half, double kept, PeakRule rule)
    : grid_(cell_m, half), decay_(kept), rule_(rule) {
  const auto edge = static_cast<std::size_t>(2 * half + 1);
  moved_.reserve(edge * edge);
}

void EdgeGrid::Add(std::span<const Edge> edges, std::int32_t ticks) {
  tick_ += ticks;
  for (const Edge& edge : edges) AddEdge(edge, decay_.Weight(ticks));
}

// Along the axis that the edge is nearer to, one step a row or column of cells: the cell in whose middle,
// along that axis, the edge crosses it, and not every cell that it touches.
void EdgeGrid::AddEdge(const Edge& edge, float weight) {
  const double dx = edge.b.x_m - edge.a.x_m, dy = edge.b.y_m - edge.a.y_m;
  const bool along_x = std::abs(dx) >= std::abs(dy);
  const double from = along_x ? edge.a.x_m : edge.a.y_m, to = along_x ? edge.b.x_m : edge.b.y_m;
  const double across = along_x ? edge.a.y_m : edge.a.x_m;
  const double slope = from == to ? 0 : (along_x ? dy : dx) / (to - from);
  const double low = std::min(from, to), high = std::max(from, to);
  const CellIndex middle = centre();
  const std::int32_t first = std::max(CellOf(low, cell_m()), (along_x ? middle.i : middle.j) - half());
  const std::int32_t last = std::min(CellOf(high, cell_m()), (along_x ? middle.i : middle.j) + half());
  AngleHistogram vote;
  vote.Add(edge.angle_rad, kPeriodRad, weight);
  for (std::int32_t step = first; step <= last; ++step) {
    const double at = std::clamp(step * cell_m(), low, high), beside = across + slope * (at - from);
    Put({along_x ? Point{at, beside} : Point{beside, at}, vote, tick_});
  }
}

void EdgeGrid::Put(const Moved& moved) {
  const std::int32_t i = CellOf(moved.at.x_m, cell_m()), j = CellOf(moved.at.y_m, cell_m());
  Cell* cell = grid_.Touch(i, j);
  if (!cell) return;
  const bool later = moved.tick >= cell->tick;
  const std::int32_t tick = later ? moved.tick : cell->tick;
  const float ours = decay_.After(tick - cell->tick), theirs = decay_.After(tick - moved.tick);
  for (std::size_t k = 0; k < kAngleBins; ++k)
    // [DM98] section 3.3: a histogram of orientations in each cell
    cell->histogram.bin[k] = ours * cell->histogram.bin[k] + theirs * moved.histogram.bin[k];
  cell->tick = tick;
  if (!later) return;
  cell->x_m = static_cast<float>(moved.at.x_m - i * cell_m());
  cell->y_m = static_cast<float>(moved.at.y_m - j * cell_m());
}

std::optional<CellEdge> EdgeGrid::Dominant(std::int32_t i, std::int32_t j) const {
  const Cell* cell = grid_.Find(i, j);
  if (!cell) return std::nullopt;
  AnglePeak peak = PeakOf(cell->histogram, kPeriodRad);
  peak.weight *= decay_.After(tick_ - cell->tick);
  if (peak.weight < rule_.weight || peak.strength < rule_.strength) return std::nullopt;
  return CellEdge{peak.angle_rad, {i * cell_m() + cell->x_m, j * cell_m() + cell->y_m}, peak.weight};
}

void EdgeGrid::Turn(double angle_rad) {
  const Point robot = grid_.robot();
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  moved_.clear();
  grid_.ForEach([&](std::int32_t i, std::int32_t j, const Cell& cell) {
    const double x = i * cell_m() + cell.x_m - robot.x_m, y = j * cell_m() + cell.y_m - robot.y_m;
    moved_.push_back({{robot.x_m + c * x - s * y, robot.y_m + s * x + c * y}, cell.histogram, cell.tick});
    moved_.back().histogram.Shift(angle_rad, kPeriodRad);
  });
  grid_.Clear();
  for (const Moved& moved : moved_) Put(moved);
}

}  // namespace cairn::local_map
