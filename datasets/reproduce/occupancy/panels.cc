#include "datasets/reproduce/occupancy/panels.h"

#include <optional>

#include "datasets/reproduce/figure_panels.h"

namespace cairn::datasets {

using report::MapLayer;
using report::PanelPicture;

namespace {

report::Box BoxOf(const std::vector<PanelPicture>& panels) {
  std::optional<report::Box> box;
  for (const PanelPicture& panel : panels) {
    const GridBox& cells = panel.cells->box;
    const report::Box here{
        cells.origin_x_m, cells.origin_x_m + static_cast<double>(cells.columns) * cells.cell_m,
        cells.origin_y_m, cells.origin_y_m + static_cast<double>(cells.rows) * cells.cell_m};
    box = box ? report::Around(*box, here) : here;
  }
  return *box;
}

}  // namespace

const Blob& ResultOf(const StageResults& results, const std::string& stage) {
  const auto it = results.find(stage);
  if (it == results.end()) throw InputError("there is no result '" + stage + "'");
  return it->second;
}

GridMaps GridMapsOf(const StageResults& results, const std::string& name) {
  return {&ResultOf(results, name + "_default"), &ResultOf(results, name + "_evidence"),
          &ResultOf(results, name + "_forward")};
}

PanelPicture GridPanel(const std::string& title, const Blob& map, MapLayer layer) {
  PanelPicture panel;
  panel.title = title;
  panel.cells = report::PictureOf(map, layer);
  if (!panel.cells) throw InputError(title + ": the map lacks what is to be drawn");
  return panel;
}

void AddGridPanels(const std::string& of, const GridMaps& maps, std::vector<PanelPicture>* panels) {
  panels->push_back(GridPanel(of + "log-odds", *maps.defaults, MapLayer::kProbability));
  panels->push_back(GridPanel(of + "log-odds, chosen", *maps.evidence, MapLayer::kProbability));
  panels->push_back(GridPanel(of + "most likely map", *maps.forward, MapLayer::kMostLikely));
  panels->push_back(GridPanel(of + "with uncertainty", *maps.forward, MapLayer::kProbability));
}

std::string DrawGridPanels(const std::vector<PanelPicture>& panels, int columns) {
  return report::DrawPanels(panels, BoxOf(panels), columns);
}

std::string SettingText(const InverseSonar& sonar) {
  return Say("p_occupied %.3f, p_free %.2f, wall %.2f m%s", sonar.p_occupied, sonar.p_free, sonar.wall_m,
             sonar.graded ? ", graded" : "");
}
}  // namespace cairn::datasets
