#include "pipelines/forward_map/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipelines/common/beam_cells.h"
#include "pipelines/common/handed_over.h"

namespace cairn::forward_map {
namespace {

constexpr double kBeamsLookedAt = 20000;

struct Blocks {
  std::int32_t column, row, columns, rows;
};

// Column sums, or row sums, of a rectangle of blocks.
std::vector<double> Profile(const Load& load, const Blocks& part, bool of_columns) {
  std::vector<double> profile(static_cast<std::size_t>(of_columns ? part.columns : part.rows));
  for (std::int32_t j = 0; j < part.rows; ++j) {
    for (std::int32_t i = 0; i < part.columns; ++i) {
      const auto block = static_cast<std::size_t>((part.row + j) * load.block_columns() + part.column + i);
      profile[static_cast<std::size_t>(of_columns ? i : j)] += load.crossings[block];
    }
  }
  return profile;
}

void Cut(const Load& load, const Blocks& part, double most, double share, std::vector<Tile>* tiles) {
  const bool of_columns = part.columns >= part.rows;
  const std::vector<double> profile = Profile(load, part, of_columns);
  double sum = 0;
  for (const double p : profile) sum += p;
  if (sum <= most || profile.size() < 2) {
    const std::int32_t x = part.column * Load::kBlock, y = part.row * Load::kBlock;
    tiles->push_back({x, y, std::min(part.columns * Load::kBlock, load.columns - x),
                      std::min(part.rows * Load::kBlock, load.rows - y)});
    return;
  }
  std::int32_t lower = 0;
  const auto length = static_cast<std::int32_t>(profile.size());
  for (double below = 0; lower < length && below < share * sum; ++lower)
    below += profile[static_cast<std::size_t>(lower)];
  lower = std::clamp(lower, 1, length - 1);
  Blocks first = part, second = part;
  (of_columns ? first.columns : first.rows) = lower;
  (of_columns ? second.column : second.row) += lower;
  (of_columns ? second.columns : second.rows) -= lower;
  Cut(load, first, most, share, tiles);
  Cut(load, second, most, share, tiles);
}

}  // namespace

void Tile::Check(const GridBox& grid) const {
  const auto within = [](const char* name, std::int64_t value, std::int64_t least, std::int64_t most) {
    RequireWithin(name, value, least, most);
  };
  within("a tile's columns", columns, 1, grid.columns);
  within("a tile's rows", rows, 1, grid.rows);
  within("a tile's column", column, 0, grid.columns - columns);
  within("a tile's row", row, 0, grid.rows - rows);
  within("a tile's cells", std::int64_t{columns} * rows, 1, std::numeric_limits<std::int32_t>::max());
}

double Load::Sum() const {
  double sum = 0;
  for (const double c : crossings) sum += c;
  return sum;
}

Load EstimateLoad(const std::vector<RangeScans>& sensors, const GridBox& box, double beyond_m) {
  Load load{static_cast<std::int32_t>(box.columns), static_cast<std::int32_t>(box.rows), {}};
  const GridBox coarse{box.origin_x_m, box.origin_y_m, Load::kBlock * box.cell_m, load.block_columns(),
                       load.block_rows()};
  load.crossings.resize(static_cast<std::size_t>(coarse.cells()));
  std::vector<BeamCell> cells;
  for (const RangeScans& scans : sensors) {
    const std::size_t beams = scans.beams.size();
    const double readings = static_cast<double>(scans.scans() * beams);
    const auto every = static_cast<std::size_t>(std::ceil(std::max(1.0, readings / kBeamsLookedAt)));
    const auto range = scans.range_m.As<double>();
    for (std::size_t r = 0; r < scans.scans() * beams; r += every) {
      const double range_m = std::isnan(range[r]) ? scans.max_range_m : range[r];
      BeamCells(coarse, scans.BeamPose(r / beams, r % beams), scans.opening_rad, range_m + beyond_m, &cells);
      // Of a beam's length and area, evenly over the blocks that it meets.
      const double length = (range_m + beyond_m) / box.cell_m;
      const double crossed = 4 / std::numbers::pi * length + scans.opening_rad / 2 * length * length;
      for (const BeamCell& cell : cells) {
        load.crossings[static_cast<std::size_t>(cell.cell)] +=
            static_cast<double>(every) * crossed / static_cast<double>(cells.size());
      }
    }
  }
  return load;
}

std::vector<Tile> CutTiles(const Load& load, double most, double share) {
  std::vector<Tile> tiles;
  Cut(load, {0, 0, load.block_columns(), load.block_rows()}, most, share, &tiles);
  return tiles;
}

}  // namespace cairn::forward_map
