#include <cmath>

#include "datasets/export.h"
#include "datasets/export_parts.h"

namespace cairn::datasets {
namespace {

constexpr double kOccupied = 0.65, kFree = 0.196;  // map_saver's

char Grey(double probability) {
  if (probability > kOccupied) return static_cast<char>(0);
  if (probability < kFree) return static_cast<char>(254);
  return static_cast<char>(205);  // a NaN too
}

}  // namespace

Written ExportRos(const Blob& result, const std::string& folder) {
  const std::optional<Grid> grid = ReadGrid(result);
  if (!grid) throw InputError("there is no grid map in it (map/grid/probability)");
  std::string image = "P5\n" + std::to_string(grid->columns) + " " + std::to_string(grid->rows) + "\n255\n";
  for (std::int64_t row = grid->rows - 1; row >= 0; --row) {  // an image begins at the top
    for (std::int64_t column = 0; column < grid->columns; ++column) {
      image += Grey(grid->probability[static_cast<std::size_t>(row * grid->columns + column)]);
    }
  }
  const std::string yaml = "image: map.pgm\nmode: trinary\nresolution: " + NumberText(grid->cell_m) +
                           "\norigin: [" + NumberText(grid->origin_x_m) + ", " +
                           NumberText(grid->origin_y_m) +
                           ", 0]\nnegate: 0\noccupied_thresh: " + NumberText(kOccupied) +
                           "\nfree_thresh: " + NumberText(kFree) + "\n";
  FolderWriter writer(folder);
  writer.Write("map.pgm", image);
  writer.Write("map.yaml", yaml);
  return writer.Finish();
}

}  // namespace cairn::datasets
