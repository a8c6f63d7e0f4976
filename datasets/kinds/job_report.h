// The report of a job: one self-contained HTML page, and a picture of each stage.
#pragma once

#include <string>
#include <vector>

#include "datasets/kinds/result_kinds.h"

namespace cairn::datasets {

// The page of a job, its stages in order: style and pictures are inside, nothing is loaded from anywhere. It
// follows the reader's light or dark scheme, has figures of their own for a phone, and prints light. Without
// a `title` it is called by its log and job, as the provenance names them. The same input gives the same
// bytes. `note`: a sentence for its reader, which stands before all else.
// Throws InputError where a result is of no kind that has a page (ResultKinds), its arrays do not fit each
// other, or its source is another's.
std::string JobReportHtml(const std::vector<ReportedStage>& stages, const std::string& title = "",
                          const std::string& note = "");

// Two results of a kind each, side by side: how far to trust them, their scores with the differences, the
// lines of their jobs that differ, and their pages; whoever looks around in a map of one looks at the same
// place of the other's. `a`, `b`: what they are called there.
// Throws as above, and InputError where the kinds differ.
struct ReportedPair {
  ReportedStage a, b;
};
std::string ComparisonHtml(const std::vector<ReportedPair>& pairs, const std::string& a,
                           const std::string& b);

// The picture of a stage, as a PNG file of `width_px` (400 to 10000): of maps with axes, a scale bar and a
// legend, of networks what they see along a run, of a localization its error or, without samples, how sure
// robots are.
// Throws as above.
std::string StagePicturePng(const ReportedStage& stage, int width_px = 1600);

}  // namespace cairn::datasets
