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

void Occupy(PointM at, Grid* grid) {
  const double column = std::floor((at.x_m - grid->origin_x_m) / grid->cell_m);
  const double row = std::floor((at.y_m - grid->origin_y_m) / grid->cell_m);
  if (!(column >= 0 && column < static_cast<double>(grid->columns))) return;
  if (!(row >= 0 && row < static_cast<double>(grid->rows))) return;
  grid->probability[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid->columns) +
                    static_cast<std::size_t>(column)] = 1;
}

}  // namespace

Written ExportRos(const Blob& result, const std::string& folder, bool replace) {
  std::optional<Grid> grid = ReadGrid(result);
  if (!grid) throw InputError("there is no grid map in it (map/grid/probability)");
  for (const MapLandmark& landmark : ReadMapLandmarks(result)) Occupy(landmark.at, &*grid);
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
  FolderWriter writer(folder, replace);
  writer.Write("map.pgm", image);
  writer.Write("map.yaml", yaml);
  return writer.Finish();
}

}  // namespace cairn::datasets
