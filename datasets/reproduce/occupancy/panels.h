// What the figures of occupancy grids are put together from: the maps that are compared, side by side.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/report/cell_picture.h"
#include "datasets/reproduce/occupancy/study.h"
#include "datasets/reproduce/panels.h"
#include "schema/blob.h"

namespace cairn::datasets {

using StageResults = std::map<std::string, Blob>;  // of all stages, by name

// Throws InputError that names a stage that is missing.
const Blob& ResultOf(const StageResults& results, const std::string& stage);

// The maps that are compared: log-odds by evidence_map's own setting and by the one chosen, forward models.
struct GridMaps {
  const Blob *defaults, *evidence, *forward;
};
GridMaps GridMapsOf(const StageResults& results, const std::string& name);

report::PanelPicture GridPanel(const std::string& title, const Blob& map, report::MapLayer layer);

// Four: log-odds, log-odds as chosen, the most likely map, with uncertainty; `of` before their titles.
void AddGridPanels(const std::string& of, const GridMaps& maps, std::vector<report::PanelPicture>* panels);

// The bytes of a PNG, over the box round all maps.
std::string DrawGridPanels(const std::vector<report::PanelPicture>& panels, int columns);

// "p_occupied 0.510, p_free 0.45, wall 0.03 m"
std::string SettingText(const InverseSonar& sonar);

}  // namespace cairn::datasets
