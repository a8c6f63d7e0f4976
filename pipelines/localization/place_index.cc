#include "pipelines/localization/place_index.h"

#include <algorithm>
#include <numeric>

#include "schema/error.h"

namespace cairn::localization {
namespace {

double Coordinate(const Place& place, bool y) { return y ? place.y_m : place.x_m; }

}  // namespace

PlaceIndex::PlaceIndex(std::vector<Place> places)
    : places_(std::move(places)), order_(places_.size()), by_y_(places_.size(), 0) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  Split(0, places_.size());
}

// Along the axis in which the range extends farther.
void PlaceIndex::Split(std::size_t first, std::size_t end) {
  if (end - first < 2) return;
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first),
             stop = order_.begin() + static_cast<std::ptrdiff_t>(end);
  const auto extent = [&](bool y) {
    const auto [low, high] = std::minmax_element(begin, stop, [&](std::size_t a, std::size_t b) {
      return Coordinate(places_[a], y) < Coordinate(places_[b], y);
    });
    return Coordinate(places_[*high], y) - Coordinate(places_[*low], y);
  };
  const bool y = extent(true) > extent(false);
  const std::size_t middle = first + (end - first) / 2;
  std::nth_element(begin, order_.begin() + static_cast<std::ptrdiff_t>(middle), stop,
                   [&](std::size_t a, std::size_t b) {
                     return std::pair(Coordinate(places_[a], y), a) < std::pair(Coordinate(places_[b], y), b);
                   });
  by_y_[middle] = y ? 1 : 0;
  Split(first, middle);
  Split(middle + 1, end);
}

std::vector<std::size_t> PlaceIndex::Nearest(const Place& from, std::size_t count) const {
  CAIRN_DEMAND(count >= 1 && count <= size(), "no such number of nearest places");
  return NearestOf(from, count, [](std::size_t) { return true; });
}

std::vector<std::size_t> PlaceIndex::Within(const Place& from, double radius_m) const {
  std::vector<std::size_t> within;
  VisitWithin(from, radius_m, [&](std::size_t place, double) { within.push_back(place); });
  std::ranges::sort(within);
  return within;
}

}  // namespace cairn::localization
