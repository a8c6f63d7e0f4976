// The page of a grid map.
#pragma once

#include <string>

#include "datasets/evaluate/grid.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// The page's body. `log` and `evaluation` may be null.
std::string GridMapHtml(const Blob& map, const Blob* log, const GridEvaluation* evaluation);

}  // namespace cairn::datasets::report
