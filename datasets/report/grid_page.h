// The page of a grid map.
#pragma once

#include <string>

#include "datasets/evaluate/grid.h"
#include "datasets/report/scene.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// The page's body. `log` and `evaluation` may be null.
std::string GridMapHtml(const Blob& map, const Blob* log, const GridEvaluation* evaluation);

// What lies on the map: where each robot was when it scanned (of its sensor of most scans) and, with both
// `log` and `evaluation`, the true walls.
Scene GridSceneOf(const Blob& map, const Blob* log, const GridEvaluation* evaluation);

}  // namespace cairn::datasets::report
