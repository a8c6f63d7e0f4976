#include "datasets/evaluate/maps/occupancy.h"

#include <limits>
#include <string>

namespace cairn::datasets {
namespace {

constexpr char kProbability[] = "map/grid/probability", kOccupied[] = "map/grid/occupied",
               kDifference[] = "map/grid/log_odds_difference";

void DemandShape(const Blob& map, const char* name, const Shape& shape) {
  if (map.at(name).shape() != shape)
    throw InputError(std::string("'") + name + "' has another shape than '" + kProbability + "'");
}

CellBox BoxOf(const Blob& map) {
  const Shape& shape = map.at(kProbability).shape();
  if (shape.size() != 2 || shape[0] == 0 || shape[1] == 0)
    throw InputError(std::string("'") + kProbability + "' is not of rows and columns");
  CellBox box{map.Scalar<double>("map/grid/origin_x_m"), map.Scalar<double>("map/grid/origin_y_m"),
              map.Scalar<double>("map/grid/cell_m"), shape[1], shape[0]};
  if (!(box.cell_m > 0) || !std::isfinite(box.cell_m + box.origin_x_m + box.origin_y_m))
    throw InputError("'map/grid/cell_m' or its origin is no length");
  return box;
}

}  // namespace

Occupancy ReadOccupancy(const Blob& map) {
  Occupancy grid{BoxOf(map), {}};
  const auto probability = map.Get<double>(kProbability);
  grid.probability.assign(probability.begin(), probability.end());
  for (const double p : grid.probability) {
    if (p < 0 || p > 1)
      throw InputError(std::string("'") + kProbability + "' holds " + std::to_string(p) +
                       ", which is no probability");
  }
  if (!map.Has(kDifference)) return grid;
  DemandShape(map, kDifference, map.at(kProbability).shape());
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
  DemandShape(map, kOccupied, map.at(kProbability).shape());
  const auto occupied = map.Get<std::uint8_t>(kOccupied);
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    if (occupied[i] != 0 || !std::isnan(grid.probability[i])) grid.probability[i] = occupied[i] != 0 ? 1 : 0;
  }
  return grid;
}

}  // namespace cairn::datasets
