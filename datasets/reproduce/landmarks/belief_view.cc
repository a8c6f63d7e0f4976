#include "datasets/reproduce/landmarks/belief_view.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets {
namespace {

template <class T>
std::vector<T> Copy(const Blob& blob, const std::string& name) {
  const auto values = blob.Get<T>(name);
  return {values.begin(), values.end()};
}

}  // namespace

BeliefView::BeliefView(const Blob& result, std::size_t robot) {
  const std::string prefix = "robot/" + std::to_string(robot) + "/beliefs/";
  time_s_ = Copy<double>(result, prefix + "time_s");
  box_ = Copy<std::int32_t>(result, prefix + "box");
  value_ = Copy<double>(result, prefix + "value");
  cell_m_ = result.Scalar<double>("map/grid/cell_m");
  std::size_t end = 0;
  for (std::size_t s = 0; 4 * s + 3 < box_.size(); ++s) {
    first_.push_back(end);
    end += static_cast<std::size_t>(std::max(0, box_[4 * s + 2])) *
           static_cast<std::size_t>(std::max(0, box_[4 * s + 3]));
  }
  if (time_s_.empty() || first_.size() != time_s_.size() || end != value_.size())
    throw InputError("'" + prefix + "': columns that do not fit");
}

std::size_t BeliefView::StepAt(double time_s) const {
  const auto after = std::ranges::upper_bound(time_s_, time_s) - time_s_.begin();
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - 1, 0));
}

report::Grid BeliefView::At(std::size_t step) const {
  const std::int32_t* box = &box_[4 * step];
  report::Grid grid;
  grid.cell_m = cell_m_;
  grid.origin = {(box[0] - 0.5) * cell_m_, (box[1] - 0.5) * cell_m_};
  grid.columns = box[2];
  grid.rows = box[3];
  const auto first = value_.begin() + static_cast<std::ptrdiff_t>(first_[step]);
  grid.probability.assign(first, first + grid.columns * grid.rows);
  return grid;
}

Point CentreOf(const report::Grid& grid, std::size_t cell) {
  const auto columns = static_cast<std::size_t>(grid.columns);
  const auto column = static_cast<double>(cell % columns);
  const std::size_t row = cell / columns;
  return {grid.origin.x_m + (column + 0.5) * grid.cell_m,
          grid.origin.y_m + (static_cast<double>(row) + 0.5) * grid.cell_m};
}

double SpreadM(const report::Grid& grid) {
  double mass = 0, x = 0, y = 0, square = 0;
  for (std::size_t i = 0; i < grid.probability.size(); ++i) {
    const Point at = CentreOf(grid, i);
    const double p = grid.probability[i];
    mass += p;
    x += p * at.x_m;
    y += p * at.y_m;
    square += p * (at.x_m * at.x_m + at.y_m * at.y_m);
  }
  return std::sqrt(std::max(0.0, square / mass - (x * x + y * y) / (mass * mass)));
}

double ShareWithin(const report::Grid& grid, Point centre, double radius_m) {
  double all = 0, within = 0;
  for (std::size_t i = 0; i < grid.probability.size(); ++i) {
    all += grid.probability[i];
    if (DistanceM(CentreOf(grid, i), centre) <= radius_m) within += grid.probability[i];
  }
  return all > 0 ? within / all : 0.0;
}

int PlacesWithShare(report::Grid grid, double radius_m, double share) {
  double all = 0;
  for (const double p : grid.probability) all += p;
  for (int places = 0;; ++places) {
    const Point peak = MostLikely(grid);
    double within = 0;
    for (std::size_t i = 0; i < grid.probability.size(); ++i) {
      if (DistanceM(CentreOf(grid, i), peak) > radius_m) continue;
      within += grid.probability[i];
      grid.probability[i] = 0;
    }
    if (within <= 0 || within < share * all) return places;
  }
}

Point MostLikely(const report::Grid& grid) {
  CAIRN_DEMAND(!grid.probability.empty(), "a cell");
  const auto best = std::ranges::max_element(grid.probability) - grid.probability.begin();
  return CentreOf(grid, static_cast<std::size_t>(best));
}

}  // namespace cairn::datasets
