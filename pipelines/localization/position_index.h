// Which positions are near another: a k-d tree over positions in the plane.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace cairn::localization {

struct Position {
  double x_m = 0.0, y_m = 0.0;
  friend bool operator==(const Position&, const Position&) = default;
  static void Fields(const auto& field) {
    field("x_m", &Position::x_m);
    field("y_m", &Position::y_m);
  }
};

inline double DistanceM(const Position& a, const Position& b) {
  const double dx = a.x_m - b.x_m, dy = a.y_m - b.y_m;
  return std::sqrt(dx * dx + dy * dy);
}

class PositionIndex {
 public:
  // Copies the positions; O(n log n).
  explicit PositionIndex(std::vector<Position> positions);

  std::size_t size() const { return positions_.size(); }

  // The `count` positions nearest to `from`, nearest first; of positions equally far away those first given.
  // 1 <= count <= size(). O(log n + count) where positions are spread evenly.
  std::vector<std::size_t> Nearest(const Position& from, std::size_t count) const;

  // The same of those positions for which `keep(position)` is true; all of these where they are fewer.
  template <class Keep>
  std::vector<std::size_t> NearestOf(const Position& from, std::size_t count, const Keep& keep) const;

  // `visit(position, distance_m)` for all positions at most `radius_m` away, in an order that the positions
  // alone decide.
  template <class Visit>
  void VisitWithin(const Position& from, double radius_m, const Visit& visit) const;

  // The same positions, ascending.
  std::vector<std::size_t> Within(const Position& from, double radius_m) const;

 private:
  struct Near {
    double distance_m;
    std::size_t position;
    auto operator<=>(const Near&) const = default;
  };

  void Split(std::size_t first, std::size_t end);
  // Visits the tree's nodes, the side of `from` first. `visit(position)`; `reach()`: how far what is still
  // looked for may be away.
  template <class Visit, class Reach>
  void Descend(std::size_t first, std::size_t end, const Position& from, const Visit& visit,
               const Reach& reach) const;

  std::vector<Position> positions_;
  std::vector<std::size_t> order_;   // the tree: the middle of a range splits it
  std::vector<unsigned char> by_y_;  // of each such middle: whether y splits, not x
};

template <class Visit, class Reach>
void PositionIndex::Descend(std::size_t first, std::size_t end, const Position& from, const Visit& visit,
                            const Reach& reach) const {
  if (first == end) return;
  const std::size_t middle = first + (end - first) / 2;
  const Position& position = positions_[order_[middle]];
  visit(order_[middle]);
  const double beyond_m = by_y_[middle] != 0 ? from.y_m - position.y_m : from.x_m - position.x_m;
  const bool low_side = beyond_m < 0.0;
  if (low_side)
    Descend(first, middle, from, visit, reach);
  else
    Descend(middle + 1, end, from, visit, reach);
  if (std::abs(beyond_m) > reach()) return;
  if (low_side)
    Descend(middle + 1, end, from, visit, reach);
  else
    Descend(first, middle, from, visit, reach);
}

template <class Keep>
std::vector<std::size_t> PositionIndex::NearestOf(const Position& from, std::size_t count,
                                                  const Keep& keep) const {
  std::vector<Near> heap;  // the farthest on top
  const auto visit = [&](std::size_t position) {
    const Near near{DistanceM(positions_[position], from), position};
    if (heap.size() == count && heap.front() < near) return;
    if (!keep(position)) return;
    if (heap.size() == count) {
      std::ranges::pop_heap(heap);
      heap.pop_back();
    }
    heap.push_back(near);
    std::ranges::push_heap(heap);
  };
  Descend(0, size(), from, visit, [&] {
    return heap.size() < count ? std::numeric_limits<double>::infinity() : heap.front().distance_m;
  });
  std::ranges::sort_heap(heap);
  std::vector<std::size_t> nearest;
  for (const Near& near : heap) nearest.push_back(near.position);
  return nearest;
}

template <class Visit>
void PositionIndex::VisitWithin(const Position& from, double radius_m, const Visit& visit) const {
  Descend(
      0, size(), from,
      [&](std::size_t position) {
        const double distance_m = DistanceM(positions_[position], from);
        if (distance_m <= radius_m) visit(position, distance_m);
      },
      [&] { return radius_m; });
}

}  // namespace cairn::localization
