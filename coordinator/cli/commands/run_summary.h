// What a run leaves behind for people, and the few lines that end it: where results, pictures and the page
// are, and how good they are where the log has ground truth.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/cli/job_file/job_file.h"
#include "datasets/evaluate/scores.h"
#include "datasets/verdicts/verdict.h"

namespace cairn::cli {

// {"trust": "high", "why": …} and what it rests on.
nlohmann::ordered_json VerdictJson(const datasets::Verdict& verdict);

// Of one stage.
struct StageSummary {
  std::string stage, kind, result, picture;  // the last two are paths; no picture: empty
  bool is_map = false;
  std::optional<datasets::Verdict> verdict = {};
  std::optional<datasets::Scores> found = {};       // what it says of itself; none: nothing
  std::optional<datasets::Scores> evaluation = {};  // where its source has truth
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
