#include "datasets/report/cell_picture.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "datasets/report/drawing/palette.h"

namespace cairn::datasets::report {
namespace {

void Append(Rgb colour, std::vector<std::uint8_t>* rgb) {
  for (const int channel : colour) rgb->push_back(static_cast<std::uint8_t>(channel));
}

CellPicture OfProbabilities(const Occupancy& map) {
  CellPicture picture{map.box, {}};
  for (const double p : map.probability) Append(OfProbability(p), &picture.rgb);
  return picture;
}

std::optional<CellPicture> OfDifferences(const Blob& map) {
  constexpr char kName[] = "map/grid/log_odds_difference";
  if (!map.Has(kName)) return std::nullopt;
  CellPicture picture{ReadOccupancy(map).box, {}};  // which checks the shape
  for (const double nats : map.Get<double>(kName)) Append(OfDifference(nats), &picture.rgb);
  return picture;
}

// schema/FORMAT.md, grid_map, map/grid/dynamic.
std::optional<CellPicture> OfDynamic(const Blob& map) {
  constexpr char kName[] = "map/grid/dynamic";
  constexpr std::uint8_t kSomebodyPassed = 1, kCameAndWent = 2;
  if (!map.Has(kName)) return std::nullopt;
  const Occupancy occupancy = ReadOccupancy(map);
  const auto dynamic = map.Get<std::uint8_t>(kName);
  CellPicture picture{occupancy.box, {}};
  for (std::size_t cell = 0; cell < dynamic.size(); ++cell) {
    const Rgb still = Mix(kPaper, OfProbability(occupancy.probability[cell]), 0.5);
    Append(dynamic[cell] == kCameAndWent      ? kForOccupied
           : dynamic[cell] == kSomebodyPassed ? kForFree
                                              : still,
           &picture.rgb);
  }
  return picture;
}

int Light(Rgb colour) { return colour[0] + colour[1] + colour[2]; }

Rgb DarkestOf(const CellPicture& picture, std::int64_t first_column, std::int64_t first_row,
              std::int64_t block) {
  Rgb darkest = kPaper;
  for (std::int64_t row = first_row; row < std::min(picture.box.rows, first_row + block); ++row) {
    for (std::int64_t column = first_column; column < std::min(picture.box.columns, first_column + block);
         ++column) {
      const Rgb colour = picture.At(column, row);
      if (Light(colour) < Light(darkest)) darkest = colour;
    }
  }
  return darkest;
}

}  // namespace

Rgb OfDifference(double nats) {
  if (!(std::abs(nats) >= kSaysNothingNats)) return kSaysNothing;
  // By the root: a nat shows beside ten.
  const double share = std::sqrt(std::min(std::abs(nats) / kFullColourNats, 1.0));
  return Mix(kSaysNothing, nats > 0 ? kForOccupied : kForFree, share);
}

std::optional<CellPicture> PictureOf(const Blob& grid_map, MapLayer layer) {
  if (layer == MapLayer::kProbability) return OfProbabilities(ReadOccupancy(grid_map));
  if (layer == MapLayer::kDifference) return OfDifferences(grid_map);
  if (layer == MapLayer::kDynamic) return OfDynamic(grid_map);
  if (!HasMostLikely(grid_map)) return std::nullopt;
  return OfProbabilities(ReadMostLikely(grid_map));
}

std::vector<CellPicture> EarlierMaps(const Blob& grid_map, std::size_t most) {
  const auto history = FieldsIn<kinds::GridMap::History>("history/", grid_map);
  const std::span<const std::int64_t> iteration = history.changed_iteration.OrNone(),
                                      cell = history.changed_cell.OrNone();
  if (iteration.size() != cell.size()) throw InputError("'history/changed_cell' has another size");
  Occupancy map = HasMostLikely(grid_map) ? ReadMostLikely(grid_map) : ReadOccupancy(grid_map);
  for (double& p : map.probability) p = std::isnan(p) ? p : 0;
  const std::set<std::int64_t> rounds(iteration.begin(), iteration.end());
  std::vector<CellPicture> maps;
  std::size_t next = 0, round = 0;
  for (const std::int64_t now : rounds) {
    for (; next < cell.size() && iteration[next] == now; ++next) {
      if (cell[next] >= map.box.cells()) throw InputError("'history/changed_cell' has none of the map's");
      double& p = map.probability[static_cast<std::size_t>(cell[next])];
      p = p == 1 ? 0 : 1;
    }
    ++round;  // the first of some is kept, and the last
    if (round * most / rounds.size() > (round - 1) * most / rounds.size())
      maps.push_back(OfProbabilities(map));
  }
  return maps;
}

CellPicture InBlocks(const CellPicture& picture, std::int64_t most) {
  const GridBox& box = picture.box;
  const std::int64_t block = (std::max(box.columns, box.rows) + most - 1) / most;
  if (block <= 1) return picture;
  CellPicture blocks{{box.origin_x_m, box.origin_y_m, box.cell_m * static_cast<double>(block),
                      (box.columns + block - 1) / block, (box.rows + block - 1) / block},
                     {}};
  for (std::int64_t row = 0; row < blocks.box.rows; ++row) {
    for (std::int64_t column = 0; column < blocks.box.columns; ++column)
      Append(DarkestOf(picture, column * block, row * block, block), &blocks.rgb);
  }
  return blocks;
}

Raster CellsRaster(const CellPicture& picture, std::int64_t most) {
  const CellPicture blocks = InBlocks(picture, most);
  Raster raster{static_cast<std::uint32_t>(blocks.box.columns),
                static_cast<std::uint32_t>(blocks.box.rows),
                PngColour::kRgb,
                {}};
  for (std::int64_t row = blocks.box.rows - 1; row >= 0; --row) {
    for (std::int64_t column = 0; column < blocks.box.columns; ++column) raster.Add(blocks.At(column, row));
  }
  return raster;
}

Box BoxOf(const GridBox& cells) {
  return {cells.origin_x_m, cells.origin_x_m + static_cast<double>(cells.columns) * cells.cell_m,
          cells.origin_y_m, cells.origin_y_m + static_cast<double>(cells.rows) * cells.cell_m};
}

std::vector<LegendEntry> ProbabilityLegend() {
  std::vector<LegendEntry> legend;
  for (const auto& [p, text] :
       {std::pair{0.0, "free"}, {0.25, "0.25"}, {0.5, "0.5"}, {0.75, "0.75"}, {1.0, "occupied"}})
    legend.push_back(SwatchEntry(OfProbability(p), text));
  legend.push_back(SwatchEntry(kUnknown, "nothing known"));
  return legend;
}

}  // namespace cairn::datasets::report
