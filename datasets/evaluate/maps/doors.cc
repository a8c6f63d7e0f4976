#include "datasets/evaluate/maps/doors.h"

#include <cmath>
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
  }

  // Whether a square of `edge` cells gets through.
  bool LetsThrough(std::int64_t edge) const {
    std::set<Cell> fits;
    std::vector<Cell> open;
    for (const Cell& cell : free_) {
      if (!Fits(cell, edge)) continue;
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

  double width_m() const { return width_m_; }

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
    for (std::int64_t row = map_.box.RowOf(middle.y_m - reach_m); row <= map_.box.RowOf(middle.y_m + reach_m);
         ++row) {
      for (std::int64_t column = map_.box.ColumnOf(middle.x_m - reach_m);
           column <= map_.box.ColumnOf(middle.x_m + reach_m); ++column) {
        const Place place = PlaceOf({column, row});
        const bool in_strip = place.along_m >= 0 && place.along_m <= width_m_ &&
                              std::abs(place.across_m) <= kThroughM + map_.box.cell_m;
        if (in_strip && map_.IsFree(column, row)) free_.insert({column, row});
      }
    }
  }

  // The square's lowest, leftmost cell is `cell`.
  bool Fits(const Cell& cell, std::int64_t edge) const {
    for (std::int64_t y = 0; y < edge; ++y) {
      for (std::int64_t x = 0; x < edge; ++x)
        if (!free_.contains({cell.first + x, cell.second + y})) return false;
    }
    return true;
  }

  template <class Is>
  bool Any(const Cell& cell, std::int64_t edge, const Is& is) const {
    for (std::int64_t y = 0; y < edge; ++y) {
      for (std::int64_t x = 0; x < edge; ++x)
        if (is(PlaceOf({cell.first + x, cell.second + y}).across_m)) return true;
    }
    return false;
  }
  bool IsBefore(const Cell& cell, std::int64_t edge) const {
    return Any(cell, edge, [](double across_m) { return across_m <= -kThroughM; });
  }
  bool IsBehind(const Cell& cell, std::int64_t edge) const {
    return Any(cell, edge, [](double across_m) { return across_m >= kThroughM; });
  }

  const Occupancy& map_;
  Wall door_;
  double width_m_;
  Point along_;
  std::set<Cell> free_;
};

}  // namespace

double PassageM(const Occupancy& map, const Wall& door) {
  const Passage passage(map, door);
  std::int64_t edge = 0;
  const auto most = static_cast<std::int64_t>(passage.width_m() / map.box.cell_m) + 1;
  while (edge < most && passage.LetsThrough(edge + 1)) ++edge;
  return static_cast<double>(edge) * map.box.cell_m;
}

}  // namespace cairn::datasets
