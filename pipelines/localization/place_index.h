// Which places are near another: a k-d tree over places in the plane.
#pragma once

#include <cstddef>
#include <vector>

namespace cairn::localization {

struct Place {
  double x_m = 0.0, y_m = 0.0;
  friend bool operator==(const Place&, const Place&) = default;
};

double DistanceM(const Place& a, const Place& b);

class PlaceIndex {
 public:
  // Copies the places; O(n log n).
  explicit PlaceIndex(std::vector<Place> places);

  std::size_t size() const { return places_.size(); }

  // The `count` places nearest to `from`, nearest first; of places equally far away those first given.
  // 1 <= count <= size(). O(log n + count) where places are spread evenly.
  std::vector<std::size_t> Nearest(const Place& from, std::size_t count) const;

  // All places at most `radius_m` away, ascending.
  std::vector<std::size_t> Within(const Place& from, double radius_m) const;

 private:
  struct Near {
    double distance_m;
    std::size_t place;
    auto operator<=>(const Near&) const = default;
  };

  void Split(std::size_t first, std::size_t end);
  // Visits the tree's nodes, the side of `from` first. `visit(place)`; `reach()`: how far what is still
  // looked for may be away.
  template <class Visit, class Reach>
  void Descend(std::size_t first, std::size_t end, const Place& from, const Visit& visit,
               const Reach& reach) const;

  std::vector<Place> places_;
  std::vector<std::size_t> order_;   // the tree: the middle of a range splits it
  std::vector<unsigned char> by_y_;  // of each such middle: whether y splits, not x
};

}  // namespace cairn::localization
