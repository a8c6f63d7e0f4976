// The page and the picture of a landmark map.
#pragma once

#include <string>

#include "datasets/evaluate/evaluate.h"
#include "schema/blob.h"

namespace cairn::cli {

// True where a log has ground truth to score against.
bool HasTruth(const Blob& log);

// Replaces `path` by the page. `log` and `evaluation` may be null; the page shows truth where both are there.
void WriteReport(const std::string& path, const std::string& title, const Blob& result, const Blob* log,
                 const datasets::Evaluation* evaluation);

}  // namespace cairn::cli
