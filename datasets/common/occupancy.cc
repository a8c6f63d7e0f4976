#include "datasets/common/occupancy.h"

#include <limits>
#include <string>

namespace cairn::datasets {
namespace {

GridBox BoxOf(const kinds::GridMap::Grid& grid) {
  const Shape& shape = grid.probability.shape();
  if (shape.size() != 2 || shape[0] == 0 || shape[1] == 0)
    throw InputError("'" + grid.probability.name() + "' is not of rows and columns");
  return {grid.origin_x_m.Scalar(), grid.origin_y_m.Scalar(), grid.cell_m.Scalar(), shape[1], shape[0]};
}

}  // namespace

std::vector<double> KnownProbabilities(const kinds::GridMap::Grid& grid) {
  std::vector<double> probability = grid.probability.vector();
  const std::span<const double> difference = grid.log_odds_difference.OrNone();
  for (std::size_t i = 0; i < std::min(difference.size(), probability.size()); ++i) {
    if (!(std::abs(difference[i]) >= kSaysNothingNats))
      probability[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return probability;
}

Occupancy ReadOccupancy(const Blob& map) {
  const auto grid = FieldsIn<kinds::GridMap::Grid>("map/grid/", map);
  return {BoxOf(grid), KnownProbabilities(grid)};
}

bool HasMostLikely(const Blob& map) { return map.Has("map/grid/occupied"); }

Occupancy ReadMostLikely(const Blob& map) {
  Occupancy grid = ReadOccupancy(map);
  const auto occupied = map.Get<std::uint8_t>("map/grid/occupied");
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    if (occupied[i] != 0 || !std::isnan(grid.probability[i])) grid.probability[i] = occupied[i] != 0 ? 1 : 0;
  }
  return grid;
}

}  // namespace cairn::datasets
