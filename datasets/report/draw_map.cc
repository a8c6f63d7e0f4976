#include "datasets/report/draw_map.h"

#include <algorithm>

#include "datasets/report/cell_picture.h"
#include "datasets/report/pictures.h"
#include "datasets/report/scene.h"

namespace cairn::datasets {
namespace report {
namespace {

constexpr std::int64_t kMostCells = 1500;

// The report's map with its legend above it.
std::string MapPng(const Scene& scene, const MapView& view, std::vector<LegendEntry> legend, int width_px) {
  CAIRN_DEMAND(width_px >= 400 && width_px <= 10000, "400 to 10000 pixels");
  constexpr double kMargin = 10;
  std::ranges::copy(LegendOf(scene), std::back_inserter(legend));
  Picture picture(width_px / kFileScale);
  const double top = kMargin + DrawLegend(legend, kMargin, kMargin, &picture);
  const Picture map = MapPicture(scene, picture.width(), view);
  picture.Add(map, {0, top});
  picture.SetHeight(top + map.height());
  return picture.Png();
}

}  // namespace
}  // namespace report

std::string DrawMapPng(const Blob& result, const Blob* log, const Evaluation* evaluation, int width_px) {
  return DrawScenePng(report::MakeScene(result, log, evaluation), width_px);
}

std::string DrawGridPng(const Blob& map, const Blob* log, const GridEvaluation* evaluation, int width_px) {
  const auto cells = InBlocks(*PictureOf(map, report::MapLayer::kProbability), report::kMostCells);
  return report::MapPng(report::GridSceneOf(map, log, evaluation),
                        {.below = report::MapCells{CellsRaster(cells), report::BoxOf(cells.box)},
                         .round_cells = true,
                         .highest = 1.4},
                        report::ProbabilityLegend(), width_px);
}

std::string DrawScenePng(const report::Scene& scene, int width_px) {
  const bool grid_alone = scene.grid && scene.landmarks.empty();
  const bool path = std::ranges::any_of(scene.paths, [](const report::Path& p) { return !p.points.empty(); });
  if (!scene.grid && scene.landmarks.empty() && !path)
    throw InputError("there is neither a map nor a path in it to draw");
  report::MapView view{.highest = 1.4};
  std::vector<report::LegendEntry> legend;
  if (scene.grid) {
    const auto colours = grid_alone ? report::GridColours::kGreys : report::GridColours::kTint;
    view.below = report::MapCells{GridRaster(*scene.grid, colours), report::BoxOf(*scene.grid)};
    if (grid_alone)
      legend = report::ProbabilityLegend();
    else
      legend.push_back(
          report::SwatchEntry(report::kTint, "P(landmark) of a cell, the stronger the likelier"));
  }
  return report::MapPng(scene, view, std::move(legend), width_px);
}

}  // namespace cairn::datasets
