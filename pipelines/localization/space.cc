#include "pipelines/localization/space.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "pipelines/localization/sensing.h"
#include "schema/error.h"
#include "schema/headings.h"

namespace cairn::localization {
namespace {

constexpr double kMostCells = 1e6;

struct Box {
  Position low, high;
};

Box BoxOf(const std::vector<Position>& positions) {
  Box box{positions.front(), positions.front()};
  for (const Position& position : positions) {
    box.low = {std::min(box.low.x_m, position.x_m), std::min(box.low.y_m, position.y_m)};
    box.high = {std::max(box.high.x_m, position.x_m), std::max(box.high.y_m, position.y_m)};
  }
  return box;
}

// Adds the cells of the box that have a sample of `training` near. They lie about its middle: a world that is
// shifted, or turned by a quarter, has the same ones.
void AddCells(double cell_m, const Box& box, const std::vector<Position>& training,
              std::vector<Position>* cells) {
  const double columns = std::floor((box.high.x_m - box.low.x_m) / cell_m) + 1,
               rows = std::floor((box.high.y_m - box.low.y_m) / cell_m) + 1;
  if (columns * rows > kMostCells) {
    throw InputError(fmt::format("cell_m = {:g} m makes {:.0f} by {:.0f} cells; at most {:.0f} are allowed",
                                 cell_m, columns, rows, kMostCells));
  }
  const PositionIndex index(training);
  const Position middle{0.5 * (box.low.x_m + box.high.x_m), 0.5 * (box.low.y_m + box.high.y_m)};
  for (int row = 0; row < static_cast<int>(rows); ++row) {
    for (int column = 0; column < static_cast<int>(columns); ++column) {
      const Position centre{middle.x_m + (column - 0.5 * (columns - 1)) * cell_m,
                            middle.y_m + (row - 0.5 * (rows - 1)) * cell_m};
      const double nearest_m = DistanceM(training[index.Nearest(centre, 1)[0]], centre);
      // [Thr98] section 2.1: the space of locations, where there are samples to know a position by
      if (nearest_m <= cell_m / std::numbers::sqrt2) cells->push_back(centre);
    }
  }
}

// The direction, modulo a quarter turn, that most samples face: corridors meet at right angles, however the
// world lies to its axes.
double Grain(const std::vector<double>& headings_rad) {
  double x = 0.0, y = 0.0;
  for (const double heading : headings_rad) {
    x += std::cos(4.0 * heading);
    y += std::sin(4.0 * heading);
  }
  return std::atan2(y, x) / 4.0;
}

// Samples that face into one quarter of the compass, about a direction of the grain.
struct Layer {
  std::vector<Position> positions;
  std::vector<double> heading_rad;
};

std::array<Layer, 4> LayersOf(const Source& source) {
  std::array<Layer, 4> layers;
  const double grain_rad = Grain(source.map_heading_rad);
  for (std::size_t k = 0; k < source.map_positions.size(); ++k) {
    const double quarters = std::round((source.map_heading_rad[k] - grain_rad) / (0.5 * std::numbers::pi));
    Layer& layer = layers[static_cast<std::size_t>(static_cast<std::int64_t>(quarters) & 3)];
    layer.positions.push_back(source.map_positions[k]);
    layer.heading_rad.push_back(source.map_heading_rad[k]);
  }
  return layers;
}

double MeanHeading(const Layer& layer, const std::vector<std::size_t>& samples) {
  double x = 0.0, y = 0.0;
  for (const std::size_t k : samples) {
    x += std::cos(layer.heading_rad[k]);
    y += std::sin(layer.heading_rad[k]);
  }
  return std::atan2(y, x);
}

Poses LayeredCells(double cell_m, const Source& source) {
  Poses poses;
  const Box box = BoxOf(source.map_positions);
  for (const Layer& layer : LayersOf(source)) {
    if (layer.positions.empty()) continue;
    AddCells(cell_m, box, layer.positions, &poses.positions);
    const PositionIndex index(layer.positions);
    for (std::size_t k = poses.heading_rad.size(); k < poses.positions.size(); ++k)
      poses.heading_rad.push_back(
          MeanHeading(layer, index.Within(poses.positions[k], cell_m / std::numbers::sqrt2)));
  }
  return poses;
}

}  // namespace

Poses BeliefPositions(const Options& options, const Source& source) {
  if (options.belief != "grid") return {source.map_positions, source.map_heading_rad};
  if (source.headings()) return LayeredCells(options.cell_m, source);
  Poses poses;
  AddCells(options.cell_m, BoxOf(source.map_positions), source.map_positions, &poses.positions);
  return poses;
}

void FeatureMap::Append(const FeatureMap& block) {
  probability.insert(probability.end(), block.probability.begin(), block.probability.end());
  room.insert(room.end(), block.room.begin(), block.room.end());
}

FeatureMap MapOfBlock(const Options& options, const Source& source, const Poses& poses, std::size_t first,
                      std::size_t end) {
  const PositionIndex training(source.map_positions), among(poses.positions);
  const double bandwidth_m =
      std::max({options.motion_m, options.motion_ratio * options.every_m, SpacingM(among, poses), 1e-3});
  FeatureMap map;
  for (std::size_t k = first; k < end; ++k) {
    const auto alike = [&](std::size_t sample) {
      return !source.headings() || FaceAlike(source.map_heading_rad[sample], poses.heading_rad[k]);
    };
    const std::vector<double> features =
        MeanFeatures(training.NearestOf(poses.positions[k], static_cast<std::size_t>(options.nearest), alike),
                     source.map_output, source.features(), options.prior_count);
    map.probability.insert(map.probability.end(), features.begin(), features.end());
    map.room.push_back(RoomOf(among, poses, k, bandwidth_m));
  }
  return map;
}

}  // namespace cairn::localization
