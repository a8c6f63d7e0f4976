#include <algorithm>
#include <cmath>

#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/svg.h"
#include "datasets/report/grid_picture.h"
#include "datasets/report/map_canvas.h"
#include "datasets/report/pictures.h"

namespace cairn::datasets::report {
namespace {

constexpr double kMapPicturesLeft = MapMargins::kLeft, kMapPicturesRight = MapMargins::kRight,
                 kMapPicturesTop = MapMargins::kTop, kMapPicturesBottom = MapMargins::kBottom;
constexpr double kMapPicturesNarrowest = 600;  // on which two maps stand side by side

// To two significant digits: "0.034".
std::string TwoDigits(double value) {
  if (!(value > 0)) return "0";
  return Short(value, std::clamp(1 - static_cast<int>(std::floor(std::log10(value))), 0, 12));
}

double Outer(double panel_height) { return kMapPicturesTop + panel_height + kMapPicturesBottom; }

Box BoxOf(const Grid& grid) {
  return {grid.origin.x_m, grid.origin.x_m + static_cast<double>(grid.columns) * grid.cell_m, grid.origin.y_m,
          grid.origin.y_m + static_cast<double>(grid.rows) * grid.cell_m};
}

}  // namespace

std::string MapPicture(const Scene& scene, double width) {
  const Box box = BoundsOf(scene, false);
  const double inner = width - kMapPicturesLeft - kMapPicturesRight;
  const double height = PanelHeight(box, inner, 0.3 * inner, std::max(0.88 * inner, 460.0));
  Svg svg(width, Outer(height), "Map with the robots' paths");
  const MapFrame frame(box, {kMapPicturesLeft, kMapPicturesTop, inner, height});
  MapCanvas canvas(svg, frame);
  canvas.Axes(true);
  canvas.Walls(scene);
  canvas.Paths(scene.truth_paths, "truth-path");
  canvas.Paths(scene.odometry_below, "raw-path");
  canvas.Paths(scene.paths, "path");
  canvas.Truth(scene);
  canvas.Loops(scene);
  canvas.Landmarks(scene, true);
  canvas.Starts(scene.paths);
  canvas.Finish();
  return svg.Finish();
}

std::string BeforeAfterPicture(const Scene& scene, double width) {
  if (scene.odometry.empty()) return {};
  constexpr double kGap = 44, kTitle = 22;
  const bool beside = width >= kMapPicturesNarrowest;
  const Box box = BoundsOf(scene, true);
  const double inner = beside ? (width - kMapPicturesLeft - kMapPicturesRight - kGap) / 2
                              : width - kMapPicturesLeft - kMapPicturesRight;
  const double height = PanelHeight(box, inner, 0.45 * inner, 1.28 * inner);
  const double pitch = kTitle + Outer(height);
  Svg svg(width, beside ? pitch : 2 * pitch, "Raw odometry and corrected paths");
  for (const bool corrected : {false, true}) {
    const double left = kMapPicturesLeft + (corrected && beside ? inner + kGap : 0),
                 top = kMapPicturesTop + kTitle + (corrected && !beside ? pitch : 0);
    const MapFrame frame(box, {left, top, inner, height});
    svg.Text(left, top - kMapPicturesTop - 2, corrected ? "corrected: most likely poses" : "raw odometry",
             "heading");
    MapCanvas canvas(svg, frame);
    canvas.Axes(!corrected || !beside);
    canvas.Paths(corrected ? scene.paths : scene.odometry, "path");
    if (corrected)
      canvas.Landmarks(scene, false);
    else
      canvas.Marks(scene.odometry_marks);
    canvas.Starts(corrected ? scene.paths : scene.odometry);
    canvas.Finish();
  }
  return svg.Finish();
}

std::string GridPicture(const Scene& scene, double width) {
  if (!scene.grid) return {};
  constexpr double kKey = 80;
  const Box box = BoundsOf(scene, false);
  const double inner = width - kMapPicturesLeft - kMapPicturesRight - kKey;
  const double height = PanelHeight(box, inner, 0.3 * inner, std::max(0.8 * inner, 420.0));
  Svg svg(width, Outer(height), "Probability of a landmark in each cell of the map");
  const MapFrame frame(box, {kMapPicturesLeft, kMapPicturesTop, inner, height});
  const double highest = HighestProbability(*scene.grid);
  MapCanvas canvas(svg, frame);
  canvas.Axes(true);
  canvas.Image(BoxOf(*scene.grid), GridPng(*scene.grid, highest));
  canvas.Finish();
  const double x = kMapPicturesLeft + inner + 18, y = kMapPicturesTop + 10,
               key_height = std::min(height - 20, 260.0);
  svg.Image(x, y, 16, key_height, KeyPng(128));
  svg.Rect(x, y, 16, key_height, "frame");
  // The picture's strength goes with the root of the probability.
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double probability = share * share * highest;
    svg.Text(x + 22, y + key_height * (1 - share) + 4, TwoDigits(probability), "tick");
  }
  return svg.Finish();
}

}  // namespace cairn::datasets::report
