#include <cmath>
#include <cstdint>
#include <vector>

#include "datasets/common/array_text.h"
#include "datasets/common/png.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"

namespace cairn::datasets {
namespace {

constexpr double kRosOccupied = 0.65, kRosFree = 0.196;  // map_saver's
constexpr std::uint8_t kUnknownGrey = 205;               // between the two, as map_saver writes it

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
  if (probability > kRosOccupied) return 0;
  return probability < kRosFree ? 254 : kUnknownGrey;
}

// Each cell's probability, as an image has them: from the top.
template <class Add>
void ForEachPixel(const Occupancy& cells, const Add& add) {
  for (std::int64_t row = cells.box.rows - 1; row >= 0; --row) {
    for (std::int64_t column = 0; column < cells.box.columns; ++column)
      add(cells.probability[cells.box.Index(column, row)]);
  }
}

std::string Pgm(const Occupancy& cells, RosMode mode) {
  std::string image =
      "P5\n" + std::to_string(cells.box.columns) + " " + std::to_string(cells.box.rows) + "\n255\n";
  ForEachPixel(cells, [&](double p) { image += static_cast<char>(Grey(p, mode)); });
  return image;
}

// What is unknown is transparent.
std::string TransparentPng(const Occupancy& cells, RosMode mode) {
  std::vector<std::uint8_t> pixels;
  ForEachPixel(cells, [&](double p) {
    const std::uint8_t grey = Grey(p, mode), alpha = std::isnan(p) ? 0 : 255;
    pixels.insert(pixels.end(), {grey, grey, grey, alpha});
  });
  return EncodePng(static_cast<std::uint32_t>(cells.box.columns), static_cast<std::uint32_t>(cells.box.rows),
                   pixels, PngColour::kRgba);
}

}  // namespace

Written ExportRos(const Blob& result, const std::string& folder, bool replace, RosMode mode) {
  const Occupancy cells = ReadCells(result);
  const bool scale = mode == RosMode::kScale;
  const std::string yaml = std::string("image: ") + (scale ? "map.png" : "map.pgm") +
                           "\nmode: " + NameOf(mode) + "\nresolution: " + NumberText(cells.box.cell_m) +
                           "\norigin: [" + NumberText(cells.box.origin_x_m) + ", " +
                           NumberText(cells.box.origin_y_m) +
                           ", 0]\nnegate: 0\noccupied_thresh: " + NumberText(kRosOccupied) +
                           "\nfree_thresh: " + NumberText(kRosFree) + "\n";
  FolderWriter writer(folder, replace);
  writer.Write("map.pgm", Pgm(cells, mode));
  if (scale) writer.Write("map.png", TransparentPng(cells, mode));
  writer.Write("map.yaml", yaml);
  return writer.Finish();
}

}  // namespace cairn::datasets
