// What a run leaves behind for people, and the few lines that end it: where results, pictures and the page
// are, and how good they are where the log has ground truth.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/cli/job_file/job_file.h"
#include "datasets/evaluate/evaluate.h"

namespace cairn::cli {

// Of one stage.
struct StageSummary {
  std::string stage, kind, result, picture;  // the last two are paths; no picture: empty
  // What follows is of a landmark_map only.
  std::string confidence = {};          // in words
  std::string refinement_refused = {};  // why; empty: it was not
  std::int64_t landmarks = 0;
  std::int64_t iterations = 0;
  std::optional<double> log_likelihood = {};
  std::optional<datasets::Evaluation> evaluation = {};  // where its log has truth
};

struct RunSummary {
  std::string note;    // "finished already", or empty
  std::string report;  // a path; empty: no stage has a page
  std::vector<StageSummary> stages;
  std::map<std::string, std::string> unscored;  // stage -> why it could not be held against its log

  std::string Text() const;
  std::string Json() const;
};

// Writes the pages of all stages into `dir` (report.h). `results`: stage name -> file.
RunSummary Summarize(const ParsedJob& parsed, const std::string& dir,
                     const std::map<std::string, std::string>& results);

}  // namespace cairn::cli
