#include "pipelines/landmark_learning/data/free_cells.h"

#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "schema/kinds/grid_map.h"

namespace cairn::landmark_learning {
namespace {

constexpr int kSteps[16][2] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},  {1, 1}, {1, -1}, {-1, 1}, {-1, -1},
                               {2, 1}, {2, -1}, {-2, 1}, {-2, -1}, {1, 2}, {1, -2}, {-1, 2}, {-1, -2}};

}  // namespace

FreeCells FreeCells::Of(const Blob& map) {
  const auto grid = FieldsIn<kinds::GridMap::Grid>("map/grid/", map);
  if (!grid.probability)
    throw InputError("the input 'map': no occupancy map in it ('map/grid/probability' is missing)");
  const Shape& shape = grid.probability.shape();
  if (shape.size() != 2 || grid.probability.empty())
    throw InputError(
        "the input 'map': 'map/grid/probability' must be [rows,columns]; a landmark map is no such map");
  FreeCells cells;
  cells.box_ = {grid.origin_x_m.Scalar(), grid.origin_y_m.Scalar(), grid.cell_m.Scalar(), shape[1], shape[0]};
  for (const double p : grid.probability) cells.free_.push_back(!(p >= 0.5));
  return cells;
}

std::optional<std::size_t> FreeCells::At(double x_m, double y_m) const {
  const std::int64_t column = box_.ColumnOf(x_m), row = box_.RowOf(y_m);
  if (!IsFree(column, row)) return {};
  return box_.Index(column, row);
}

// All cells that the straight step touches must be free: it cuts no corner.
bool FreeCells::CanStep(std::int64_t x, std::int64_t y, int dx, int dy) const {
  if (!IsFree(x + dx, y + dy)) return false;
  if (dx == 0 || dy == 0) return true;
  const int sx = dx > 0 ? 1 : -1, sy = dy > 0 ? 1 : -1;
  if (dx == sx && dy == sy) return IsFree(x + sx, y) && IsFree(x, y + sy);
  if (dx != sx) return IsFree(x + sx, y) && IsFree(x + sx, y + sy);
  return IsFree(x, y + sy) && IsFree(x + sx, y + sy);
}

std::vector<double> FreeCells::PathLengthsFrom(std::size_t cell) const {
  std::vector<double> path_m(free_.size(), std::numeric_limits<double>::infinity());
  using Reached = std::pair<double, std::size_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  path_m[cell] = 0.0;
  open.push({0.0, cell});
  while (!open.empty()) {
    const auto [so_far, at] = open.top();
    open.pop();
    if (so_far > path_m[at]) continue;
    const auto x = static_cast<std::int64_t>(at) % box_.columns,
               y = static_cast<std::int64_t>(at) / box_.columns;
    for (const auto& [dx, dy] : kSteps) {
      if (!CanStep(x, y, dx, dy)) continue;
      const auto to = box_.Index(x + dx, y + dy);
      // [Thr98] section 5.1.5: the way that a robot must travel
      const double there = so_far + box_.cell_m * std::sqrt(static_cast<double>(dx * dx + dy * dy));
      if (there >= path_m[to]) continue;
      path_m[to] = there;
      open.push({there, to});
    }
  }
  return path_m;
}

}  // namespace cairn::landmark_learning
