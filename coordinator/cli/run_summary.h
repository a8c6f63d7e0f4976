// What a run leaves behind for people, and the few lines that end it: where map, picture and report are, and
// how good they are where the log has ground truth.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/cli/job_file.h"
#include "datasets/evaluate/evaluate.h"

namespace cairn::cli {

// Of one stage that made a landmark map.
struct StageSummary {
  std::string stage, map, picture, report;  // the last three are paths
  std::string confidence;                   // in words
  std::string refinement_refused;           // why; empty: it was not
  std::int64_t landmarks = 0;
  std::int64_t iterations = 0;
  std::optional<double> log_likelihood;
  std::optional<datasets::Evaluation> evaluation;  // where its log has truth
};

struct RunSummary {
  std::string note;  // "finished already", or empty
  std::vector<StageSummary> stages;
  std::map<std::string, std::string> other_results;  // stage name -> file, of other kinds

  std::string Text() const;
  std::string Json() const;
};

// Writes map.png and report.html of the last landmark map into `dir`, those of others into DIR/STAGE/.
// `results`: stage name -> file.
RunSummary Summarize(const ParsedJob& parsed, const std::string& dir,
                     const std::map<std::string, std::string>& results);

}  // namespace cairn::cli
