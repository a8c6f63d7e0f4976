// The layers of a grid map as coloured cells.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/common/occupancy.h"
#include "datasets/report/drawing/picture.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

enum class MapLayer {
  kProbability,  // white: free, black: occupied, bluish: nothing is known (palette.h)
  kMostLikely,   // the same of the most likely map
  kDifference,   // blue: the data speak for free, red: for occupied, grey: for neither
  kDynamic,      // over the first, paler: blue where somebody passed, red where an obstacle came and went
};

struct CellPicture {
  GridBox box;
  std::vector<std::uint8_t> rgb;  // [rows][columns][3], row 0 the lowest y

  Rgb At(std::int64_t column, std::int64_t row) const {
    const std::size_t i = 3 * box.Index(column, row);
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

// Differences beyond it have a full colour.
inline constexpr double kFullColourNats = 10;

inline constexpr Rgb kForFree{31, 111, 181}, kForOccupied{179, 38, 30}, kSaysNothing{208, 208, 208};

// The colour of a difference of log-likelihoods.
Rgb OfDifference(double nats);

// None where the map has no such layer.
// Throws InputError where its arrays do not fit each other.
std::optional<CellPicture> PictureOf(const Blob& grid_map, MapLayer layer);

// The maps that a search held before it came to its most likely one, or to what it holds now: of more than
// `most` some, evenly spread. What nothing is known of in the end is so in all of them.
// Throws InputError where the cells that changed are not the map's.
std::vector<CellPicture> EarlierMaps(const Blob& grid_map, std::size_t most = 40);

// Of a map of more cells than `most` along an edge, a cell for each block: the darkest of it.
CellPicture InBlocks(const CellPicture& picture, std::int64_t most);

// A pixel a cell, north up; of a larger map a pixel a block, as above.
Raster CellsRaster(const CellPicture& picture, std::int64_t most = 3000);

Box BoxOf(const GridBox& cells);

// The scale of probabilities, and what is not on it.
std::vector<LegendEntry> ProbabilityLegend();

}  // namespace cairn::datasets::report
