#include "datasets/report/drawing/labels.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace cairn::datasets::report {
namespace {

struct Area {
  double left, right, top, bottom;

  bool Meets(const Area& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool Within(const Panel& p) const {
    return left >= p.left && right <= p.left + p.width && top >= p.top && bottom <= p.top + p.height;
  }
};

// Right and left, above and below, then level with the point.
std::array<Area, 6> Places(const Label& label, double height, double clear) {
  const double gap = clear + 1, above = label.at.y_m - gap, level = label.at.y_m + height / 2,
               below = label.at.y_m + gap + height;
  const double right = label.at.x_m + gap, left = label.at.x_m - gap - label.width;
  std::array<Area, 6> places{};
  std::size_t next = 0;
  for (const double baseline : {above, below, level}) {
    for (const double from : {right, left})
      places[next++] = {from, from + label.width, baseline - height, baseline};
  }
  return places;
}

}  // namespace

std::vector<PlacedLabel> PlaceLabels(const std::vector<Label>& labels, const Panel& panel, double height,
                                     double clear) {
  std::vector<std::size_t> order(labels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>{}, [&](std::size_t k) { return labels[k].weight; });
  std::vector<Area> taken;
  std::vector<PlacedLabel> placed;
  for (const std::size_t k : order) {
    for (const Area& place : Places(labels[k], height, clear)) {
      if (!place.Within(panel)) continue;
      const auto covers = [&](const Area& other) { return place.Meets(other); };
      const auto hides = [&](const Label& other) {
        return place.Meets(
            {other.at.x_m - clear, other.at.x_m + clear, other.at.y_m - clear, other.at.y_m + clear});
      };
      if (std::ranges::any_of(taken, covers) || std::ranges::any_of(labels, hides)) continue;
      taken.push_back(place);
      placed.push_back({k, {place.left, place.bottom}});
      break;
    }
  }
  return placed;
}

}  // namespace cairn::datasets::report
