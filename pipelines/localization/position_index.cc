#include "pipelines/localization/position_index.h"

#include <algorithm>
#include <numeric>

#include "schema/error.h"

namespace cairn::localization {
namespace {

double Coordinate(const Position& position, bool y) { return y ? position.y_m : position.x_m; }

}  // namespace

PositionIndex::PositionIndex(std::vector<Position> positions)
    : positions_(std::move(positions)), order_(positions_.size()), by_y_(positions_.size(), 0) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  Split(0, positions_.size());
}

// Along the axis in which the range extends farther.
void PositionIndex::Split(std::size_t first, std::size_t end) {
  if (end - first < 2) return;
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first),
             stop = order_.begin() + static_cast<std::ptrdiff_t>(end);
  const auto extent = [&](bool y) {
    const auto [low, high] = std::minmax_element(begin, stop, [&](std::size_t a, std::size_t b) {
      return Coordinate(positions_[a], y) < Coordinate(positions_[b], y);
    });
    return Coordinate(positions_[*high], y) - Coordinate(positions_[*low], y);
  };
  const bool y = extent(true) > extent(false);
  const std::size_t middle = first + (end - first) / 2;
  std::nth_element(
      begin, order_.begin() + static_cast<std::ptrdiff_t>(middle), stop, [&](std::size_t a, std::size_t b) {
        return std::pair(Coordinate(positions_[a], y), a) < std::pair(Coordinate(positions_[b], y), b);
      });
  by_y_[middle] = y ? 1 : 0;
  Split(first, middle);
  Split(middle + 1, end);
}

std::vector<std::size_t> PositionIndex::Nearest(const Position& from, std::size_t count) const {
  CAIRN_DEMAND(count >= 1 && count <= size(), "no such number of nearest positions");
  return NearestOf(from, count, [](std::size_t) { return true; });
}

std::vector<std::size_t> PositionIndex::Within(const Position& from, double radius_m) const {
  std::vector<std::size_t> within;
  VisitWithin(from, radius_m, [&](std::size_t position, double) { within.push_back(position); });
  std::ranges::sort(within);
  return within;
}

}  // namespace cairn::localization
