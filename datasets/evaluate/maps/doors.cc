#include "datasets/evaluate/maps/doors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace cairn::datasets {
namespace {

using Cell = std::pair<std::int64_t, std::int64_t>;  // column, row

class Passage {
 public:
  Passage(const Occupancy& map, const Wall& door)
      : map_(map), door_(door), width_m_(DistanceM(door.a, door.b)) {
    along_ = {(door.b.x_m - door.a.x_m) / width_m_, (door.b.y_m - door.a.y_m) / width_m_};
    CollectFree();
    GrowSquares();
  }

  // Whether a square of `edge` cells gets through.
  bool LetsThrough(std::int64_t edge) const {
    std::set<Cell> fits;
    std::vector<Cell> open;
    for (const auto& [cell, largest] : largest_) {
      if (largest < edge) continue;
      fits.insert(cell);
      if (IsBefore(cell, edge)) open.push_back(cell);
    }
    for (const Cell& cell : open) fits.erase(cell);
    while (!open.empty()) {
      const Cell at = open.back();
      open.pop_back();
      if (IsBehind(at, edge)) return true;
      for (const Cell& next : {Cell{at.first + 1, at.second}, Cell{at.first - 1, at.second},
                               Cell{at.first, at.second + 1}, Cell{at.first, at.second - 1}})
        if (fits.erase(next) != 0) open.push_back(next);
    }
    return false;
  }

  // The edge of the largest square that fits somewhere in the strip.
  std::int64_t largest() const {
    std::int64_t most = 0;
    for (const auto& [cell, largest] : largest_) most = std::max(most, largest);
    return most;
  }

 private:
  struct Place {
    double along_m, across_m;  // across: behind the opening, seen with its first end to the right
  };
  Place PlaceOf(const Cell& cell) const {
    const Point at = map_.box.Centre(cell.first, cell.second);
    const double dx = at.x_m - door_.a.x_m, dy = at.y_m - door_.a.y_m;
    return {dx * along_.x_m + dy * along_.y_m, dy * along_.x_m - dx * along_.y_m};
  }

  // Cells of the strip.
  void CollectFree() {
    const double reach_m = width_m_ + 2 * kThroughM + 2 * map_.box.cell_m;
    const Point middle{(door_.a.x_m + door_.b.x_m) / 2, (door_.a.y_m + door_.b.y_m) / 2};
    const GridBox& box = map_.box;  // nothing beyond it is free
    const std::int64_t last_row = std::min(box.RowOf(middle.y_m + reach_m), box.rows - 1),
                       last_column = std::min(box.ColumnOf(middle.x_m + reach_m), box.columns - 1);
    for (std::int64_t row = std::max<std::int64_t>(box.RowOf(middle.y_m - reach_m), 0); row <= last_row;
         ++row) {
      for (std::int64_t column = std::max<std::int64_t>(box.ColumnOf(middle.x_m - reach_m), 0);
           column <= last_column; ++column) {
        const Place place = PlaceOf({column, row});
        const bool in_strip = place.along_m >= 0 && place.along_m <= width_m_ &&
                              std::abs(place.across_m) <= kThroughM + box.cell_m;
        if (in_strip && map_.IsFree(column, row)) largest_.emplace(Cell{column, row}, 1);
      }
    }
  }

  // From the last cell on: a square is one more than those that begin beside, above and aslant.
  void GrowSquares() {
    const auto at = [&](std::int64_t column, std::int64_t row) {
      const auto found = largest_.find({column, row});
      return found == largest_.end() ? 0 : found->second;
    };
    for (auto square = largest_.rbegin(); square != largest_.rend(); ++square) {
      const auto [column, row] = square->first;
      square->second = 1 + std::min({at(column + 1, row), at(column, row + 1), at(column + 1, row + 1)});
    }
  }

  // Of the square's cells the farthest before and behind the opening are two of its corners.
  std::pair<double, double> AcrossM(const Cell& cell, std::int64_t edge) const {
    const std::int64_t last = edge - 1;
    return std::minmax({PlaceOf(cell).across_m, PlaceOf({cell.first + last, cell.second}).across_m,
                        PlaceOf({cell.first, cell.second + last}).across_m,
                        PlaceOf({cell.first + last, cell.second + last}).across_m});
  }
  bool IsBefore(const Cell& cell, std::int64_t edge) const { return AcrossM(cell, edge).first <= -kThroughM; }
  bool IsBehind(const Cell& cell, std::int64_t edge) const { return AcrossM(cell, edge).second >= kThroughM; }

  const Occupancy& map_;
  Wall door_;
  double width_m_;
  Point along_;
  std::map<Cell, std::int64_t>
      largest_;  // edge of the square of free cells whose lowest, leftmost cell it is
};

}  // namespace

double PassageM(const Occupancy& map, const Wall& door) {
  const Passage passage(map, door);
  // What a square gets through, a smaller one does.
  std::int64_t edge = 0, too_large = passage.largest() + 1;
  while (edge + 1 < too_large) {
    const std::int64_t middle = edge + (too_large - edge) / 2;
    (passage.LetsThrough(middle) ? edge : too_large) = middle;
  }
  return static_cast<double>(edge) * map.box.cell_m;
}

}  // namespace cairn::datasets
