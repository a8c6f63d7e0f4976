// The report's page about learned networks: how training went, and what the networks see along the way.
#pragma once

#include <string>
#include <vector>

#include "datasets/report/drawing/charts.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// The page's parts between title and footer. `result`: of kind `networks`.
// Throws InputError where its arrays do not fit each other.
std::string NetworksHtml(const Blob& result);

// What each network makes of the positions it was trained at, by distance travelled in the first run.
// Throws InputError where the arrays of `map/` do not fit each other.
std::vector<std::vector<ChartPoint>> OutputsAlongRun(const Blob& result);

// The same as the bytes of a PNG.
std::string NetworksPng(const Blob& result);

}  // namespace cairn::datasets::report
