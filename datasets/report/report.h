// The report of a job: one self-contained HTML page, and a picture of each stage.
#pragma once

#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/grid.h"
#include "datasets/evaluate/local.h"
#include "schema/blob.h"

namespace cairn::datasets {

// A stage of a job on its page: its result, what it was made from, and how good it is. `source` (the log,
// with or without truth; of networks and of a localization the samples) may be null, and so may every
// evaluation: without a log there is no raw odometry, without an evaluation no truth.
struct ReportedStage {
  std::string name;
  const Blob* result = nullptr;
  const Blob* source = nullptr;
  const Evaluation* evaluation = nullptr;             // of a landmark_map
  const GridEvaluation* grid_evaluation = nullptr;    // of a grid_map
  const LocalEvaluation* local_evaluation = nullptr;  // of a local_map
};

// Whether results of this kind (schema/FORMAT.md) have a page and a picture: landmark_map, grid_map,
// local_map, networks, localization, samples.
bool HasReport(const std::string& kind);

// The page of a job, its stages in order: style and pictures are inside, nothing is loaded from anywhere. It
// follows the reader's light or dark scheme, has figures of their own for a phone, and prints light. Without
// a `title` it is called by its log and job, as the provenance names them. The same input gives the same
// bytes. Throws InputError where a result is of no kind that has a page, its arrays do not fit each other, or
// its source is another's.
std::string JobReportHtml(const std::vector<ReportedStage>& stages, const std::string& title = "");

// The picture of a stage, as a PNG file of `width_px` (400 to 10000): of maps with axes, a scale bar and a
// legend, of networks what they see along a run, of a localization its error or, without samples, how sure
// robots are. Throws as above.
std::string StagePicturePng(const ReportedStage& stage, int width_px = 1600);

}  // namespace cairn::datasets
