// The report's map as a picture for other programs.
#pragma once

#include <string>

#include "datasets/evaluate/evaluate.h"
#include "schema/blob.h"

namespace cairn::datasets {

// The bytes of a PNG file of `width_px` (400 to 10000): paths, landmarks with their 95% regions, the grid
// beneath, axes, a scale bar and a legend. `log` and `evaluation` may be null; truth is drawn where both are
// there. A grid without landmarks is drawn in shades of grey, unknown cells in between. Throws InputError
// where there is neither a grid, a landmark nor a path in `result`.
std::string DrawMapPng(const Blob& result, const Blob* log, const Evaluation* evaluation,
                       int width_px = 1600);

}  // namespace cairn::datasets
