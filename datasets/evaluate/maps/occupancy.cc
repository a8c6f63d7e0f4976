#include "datasets/evaluate/maps/occupancy.h"

#include <limits>
#include <string>

namespace cairn::datasets {
namespace {

constexpr char kProbability[] = "map/grid/probability", kOccupied[] = "map/grid/occupied",
               kDifference[] = "map/grid/log_odds_difference";

CellBox BoxOf(const Blob& map) {
  const Shape& shape = map.at(kProbability).shape();
  if (shape.size() != 2 || shape[0] == 0 || shape[1] == 0)
    throw InputError(std::string("'") + kProbability + "' is not of rows and columns");
  return {map.Scalar<double>("map/grid/origin_x_m"), map.Scalar<double>("map/grid/origin_y_m"),
          map.Scalar<double>("map/grid/cell_m"), shape[1], shape[0]};
}

}  // namespace

Occupancy ReadOccupancy(const Blob& map) {
  Occupancy grid{BoxOf(map), {}};
  const auto probability = map.Get<double>(kProbability);
  grid.probability.assign(probability.begin(), probability.end());
  if (!map.Has(kDifference)) return grid;
  const auto difference = map.Get<double>(kDifference);
  for (std::size_t i = 0; i < difference.size(); ++i) {
    if (!(std::abs(difference[i]) >= kSaysNothingNats))
      grid.probability[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return grid;
}

bool HasMostLikely(const Blob& map) { return map.Has(kOccupied); }

Occupancy ReadMostLikely(const Blob& map) {
  Occupancy grid = ReadOccupancy(map);
  const auto occupied = map.Get<std::uint8_t>(kOccupied);
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    if (occupied[i] != 0 || !std::isnan(grid.probability[i])) grid.probability[i] = occupied[i] != 0 ? 1 : 0;
  }
  return grid;
}

}  // namespace cairn::datasets
