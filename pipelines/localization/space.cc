#include "pipelines/localization/space.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "pipelines/localization/sensing.h"
#include "schema/error.h"

namespace cairn::localization {
namespace {

constexpr double kMostCells = 1e6;

struct Box {
  Place low, high;
};

Box BoxOf(const std::vector<Place>& places) {
  Box box{places.front(), places.front()};
  for (const Place& place : places) {
    box.low = {std::min(box.low.x_m, place.x_m), std::min(box.low.y_m, place.y_m)};
    box.high = {std::max(box.high.x_m, place.x_m), std::max(box.high.y_m, place.y_m)};
  }
  return box;
}

std::vector<Place> GridCells(double cell_m, const std::vector<Place>& training) {
  const Box box = BoxOf(training);
  const double columns = std::floor((box.high.x_m - box.low.x_m) / cell_m) + 1,
               rows = std::floor((box.high.y_m - box.low.y_m) / cell_m) + 1;
  if (columns * rows > kMostCells) {
    char text[160];
    std::snprintf(text, sizeof text, "cell_m = %g m makes %.0f by %.0f cells; at most %.0f are allowed",
                  cell_m, columns, rows, kMostCells);
    throw InputError(text);
  }
  const PlaceIndex index(training);
  std::vector<Place> cells;
  for (int row = 0; row < static_cast<int>(rows); ++row) {
    for (int column = 0; column < static_cast<int>(columns); ++column) {
      const Place centre{box.low.x_m + (column + 0.5) * cell_m, box.low.y_m + (row + 0.5) * cell_m};
      const double nearest_m = DistanceM(training[index.Nearest(centre, 1)[0]], centre);
      if (nearest_m <= cell_m / std::numbers::sqrt2) cells.push_back(centre);
    }
  }
  return cells;
}

}  // namespace

std::vector<Place> BeliefPlaces(const Options& options, const std::vector<Place>& training) {
  return options.belief == "grid" ? GridCells(options.cell_m, training) : training;
}

Blob FeatureMap::ToBlob() const {
  Blob blob;
  blob.PutVector("probability", probability);
  blob.PutVector("room", room);
  return blob;
}

FeatureMap FeatureMap::FromBlob(const Blob& blob) {
  const auto probability = blob.Get<double>("probability"), room = blob.Get<double>("room");
  return {{probability.begin(), probability.end()}, {room.begin(), room.end()}};
}

void FeatureMap::Append(const FeatureMap& block) {
  probability.insert(probability.end(), block.probability.begin(), block.probability.end());
  room.insert(room.end(), block.room.begin(), block.room.end());
}

FeatureMap MapOfBlock(const Options& options, const Source& source, const std::vector<Place>& places,
                      std::size_t first, std::size_t end) {
  const PlaceIndex training(source.map_places), among(places);
  const double bandwidth_m =
      std::max({options.motion_m, options.motion_ratio * options.every_m, SpacingM(among, places), 1e-3});
  FeatureMap map;
  for (std::size_t k = first; k < end; ++k) {
    const std::vector<double> features =
        FeaturesAt(training, source.map_output, source.features(), static_cast<std::size_t>(options.nearest),
                   options.prior_count, places[k]);
    map.probability.insert(map.probability.end(), features.begin(), features.end());
    map.room.push_back(RoomOf(among, places, places[k], bandwidth_m));
  }
  return map;
}

}  // namespace cairn::localization
