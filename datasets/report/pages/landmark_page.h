// The page of a landmark map.
#pragma once

#include <string>

#include "datasets/evaluate/evaluate.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// The page's body. `log` and `evaluation` may be null.
// Throws InputError where `result` is no landmark_map, or the log's robots are not the result's.
std::string LandmarkMapHtml(const Blob& result, const Blob* log, const Evaluation* evaluation);

}  // namespace cairn::datasets::report
