#include <cmath>
#include <cstdint>
#include <vector>

#include "datasets/export.h"
#include "datasets/export_parts.h"
#include "datasets/png.h"

namespace cairn::datasets {
namespace {

constexpr double kOccupied = 0.65, kFree = 0.196;  // map_saver's
constexpr std::uint8_t kUnknownGrey = 205;         // between the two, as map_saver writes it

const char* NameOf(RosMode mode) {
  switch (mode) {
    case RosMode::kTrinary:
      return "trinary";
    case RosMode::kScale:
      return "scale";
    case RosMode::kRaw:
      return "raw";
  }
  return "";
}

// What map_server makes of it: occupancy = (255 - grey) / 255, or with mode raw the value itself.
std::uint8_t Grey(double probability, RosMode mode) {
  if (mode == RosMode::kRaw)
    return std::isnan(probability) ? 255 : static_cast<std::uint8_t>(std::lround(100 * probability));
  if (std::isnan(probability)) return kUnknownGrey;
  if (mode == RosMode::kScale) return static_cast<std::uint8_t>(std::lround(255 * (1 - probability)));
  if (probability > kOccupied) return 0;
  return probability < kFree ? 254 : kUnknownGrey;
}

void Occupy(PointM at, Grid* grid) {
  const double column = std::floor((at.x_m - grid->origin_x_m) / grid->cell_m);
  const double row = std::floor((at.y_m - grid->origin_y_m) / grid->cell_m);
  if (!(column >= 0 && column < static_cast<double>(grid->columns))) return;
  if (!(row >= 0 && row < static_cast<double>(grid->rows))) return;
  grid->probability[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid->columns) +
                    static_cast<std::size_t>(column)] = 1;
}

// Each cell's probability, as an image has them: from the top.
template <class Add>
void ForEachPixel(const Grid& grid, const Add& add) {
  for (std::int64_t row = grid.rows - 1; row >= 0; --row) {
    for (std::int64_t column = 0; column < grid.columns; ++column)
      add(grid.probability[static_cast<std::size_t>(row * grid.columns + column)]);
  }
}

std::string Pgm(const Grid& grid, RosMode mode) {
  std::string image = "P5\n" + std::to_string(grid.columns) + " " + std::to_string(grid.rows) + "\n255\n";
  ForEachPixel(grid, [&](double p) { image += static_cast<char>(Grey(p, mode)); });
  return image;
}

// What is unknown is transparent.
std::string TransparentPng(const Grid& grid, RosMode mode) {
  std::vector<std::uint8_t> pixels;
  ForEachPixel(grid, [&](double p) {
    const std::uint8_t grey = Grey(p, mode), alpha = std::isnan(p) ? 0 : 255;
    pixels.insert(pixels.end(), {grey, grey, grey, alpha});
  });
  return EncodePng(static_cast<std::uint32_t>(grid.columns), static_cast<std::uint32_t>(grid.rows), pixels,
                   PngColour::kRgba);
}

}  // namespace

Written ExportRos(const Blob& result, const std::string& folder, bool replace, RosMode mode) {
  std::optional<Grid> grid = ReadGrid(result);
  if (!grid) throw InputError("there is no grid map in it (map/grid/probability)");
  for (const double p : grid->probability) {
    if (!std::isnan(p) && !(p >= 0 && p <= 1)) throw InputError("map/grid/probability is beyond 0 and 1");
  }
  for (const MapLandmark& landmark : ReadMapLandmarks(result)) Occupy(landmark.at, &*grid);
  const bool scale = mode == RosMode::kScale;
  const std::string yaml =
      std::string("image: ") + (scale ? "map.png" : "map.pgm") + "\nmode: " + NameOf(mode) +
      "\nresolution: " + NumberText(grid->cell_m) + "\norigin: [" + NumberText(grid->origin_x_m) + ", " +
      NumberText(grid->origin_y_m) + ", 0]\nnegate: 0\noccupied_thresh: " + NumberText(kOccupied) +
      "\nfree_thresh: " + NumberText(kFree) + "\n";
  FolderWriter writer(folder, replace);
  writer.Write("map.pgm", Pgm(*grid, mode));
  if (scale) writer.Write("map.png", TransparentPng(*grid, mode));
  writer.Write("map.yaml", yaml);
  return writer.Finish();
}

}  // namespace cairn::datasets
