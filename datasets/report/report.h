// The report of a result: one self-contained HTML page.
#pragma once

#include <string>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/evaluate_grid.h"
#include "datasets/evaluate/evaluate_local.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct ReportOptions {
  std::string title = "Landmark map";
};

// A page of its own: style and pictures are inside, nothing is loaded from anywhere. It follows the reader's
// light or dark scheme, and prints light. `log`, with or without truth, and `evaluation` may be null: without
// a log there is no raw odometry, without an evaluation no truth. The same input gives the same bytes. Throws
// InputError where `result` is no landmark_map, or the log's robots are not the result's.
std::string ReportHtml(const Blob& result, const Blob* log, const Evaluation* evaluation,
                       const ReportOptions& options = {});

// The same of learned networks: how training went, what the networks see. Throws InputError where `result` is
// not of kind `networks`, or its arrays do not fit each other.
std::string NetworksReportHtml(const Blob& result, const std::string& title);

// The same of localised robots: error by way travelled, what some of them believe. Without `samples`, which
// may be null, there are no errors. Throws InputError where `result` is not of kind `localization`, was not
// made from these samples, or its arrays do not fit each other.
std::string LocalizationReportHtml(const Blob& result, const Blob* samples, const std::string& title);

// The same of a grid map: its layers with the way of the scans, the log-likelihood, parameters. With
// `evaluation` its scores, and with `log` too (either may be null) the true walls. Throws InputError where
// `map` is not of kind `grid_map`, or its arrays do not fit each other.
std::string GridMapReportHtml(const Blob& map, const Blob* log, const GridEvaluation* evaluation,
                              const std::string& title);

// The same of a local map: the path put together from its traces, the direction of the walls, local grids,
// traces. With `log` odometry alone and immediate traces, with `evaluation` too the truth and errors (either
// may be null). Throws InputError where `result` is not of kind `local_map`, or its arrays do not fit each
// other.
std::string LocalMapReportHtml(const Blob& result, const Blob* log, const LocalEvaluation* evaluation,
                               const std::string& title);

}  // namespace cairn::datasets
