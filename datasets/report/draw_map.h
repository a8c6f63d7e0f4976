// The report's maps as pictures for other programs: paths, landmarks with their 95% regions, the grid
// beneath, axes in metres, a scale bar and a legend. All return the bytes of a PNG file of `width_px` (400 to
// 10000).
#pragma once

#include <string>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/grid.h"
#include "datasets/report/scene.h"
#include "schema/blob.h"

namespace cairn::datasets {

// Of a landmark_map. `log` and `evaluation` may be null; truth is drawn where both are there. A grid without
// landmarks is drawn in shades of grey, unknown cells in a colour of their own.
// Throws InputError where there is neither a grid, a landmark nor a path in `result`.
std::string DrawMapPng(const Blob& result, const Blob* log, const Evaluation* evaluation,
                       int width_px = 1600);

// Of a grid_map: its probabilities, where the scans were taken and, with both `log` and `evaluation` (either
// may be null), the true walls.
std::string DrawGridPng(const Blob& map, const Blob* log, const GridEvaluation* evaluation,
                        int width_px = 1600);

// Whatever is in the scene.
// Throws InputError where there is nothing.
std::string DrawScenePng(const report::Scene& scene, int width_px = 1600);

}  // namespace cairn::datasets
