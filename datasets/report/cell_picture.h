// The layers of a grid map as coloured cells.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/occupancy.h"
#include "datasets/report/canvas.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

enum class MapLayer {
  kProbability,  // white: free, black: occupied, grey: nothing is known
  kMostLikely,   // the same of the most likely map
  kDifference,   // blue: the data speak for free, red: for occupied, grey: for neither
  kDynamic,      // over the first, paler: blue where somebody passed, red where an obstacle came and went
};

struct CellPicture {
  CellBox box;
  std::vector<std::uint8_t> rgb;  // [rows][columns][3], row 0 the lowest y

  Rgb At(std::int64_t column, std::int64_t row) const {
    const std::size_t i = 3 * box.Index(column, row);
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

// Differences beyond it have a full colour.
inline constexpr double kFullColourNats = 10;

// None where the map has no such layer. Throws InputError where its arrays do not fit each other.
std::optional<CellPicture> PictureOf(const Blob& grid_map, MapLayer layer);

// The bytes of a PNG, a pixel a cell; of a larger map than 3000 cells a pixel for a block, the darkest of it.
std::string CellsPng(const CellPicture& picture);

}  // namespace cairn::datasets::report
