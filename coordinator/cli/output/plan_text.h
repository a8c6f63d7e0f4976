// What a job would do, for --dry-run.
#pragma once

#include <map>
#include <string>

#include "coordinator/cli/job_file/catalog.h"
#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn::cli {

struct Plan {
  const proto::Job& job;
  const std::map<std::string, BlobPtr>& inputs;
  const Catalog& catalog;
  std::string first_stage;                 // what its pipeline says of it when it has planned
  std::map<std::string, double> expected;  // its figures
};

// Inputs with their sizes, then the stages with every option, given or default, and what is expected.
std::string PlanText(const Plan& plan);

// {"job", "seed", "inputs": {NAME: {"path", "bytes", "what"}}, "stages": [{"name", "pipeline", "inputs",
// "options"}], "expected": {NAME: number}, "note"}
std::string PlanJson(const Plan& plan);

// One line about a log, "2 robots, 2000 controls, 130 observations", a table of poses, or samples, "2 runs,
// 551 samples, 140 inputs". Empty for another kind of file.
std::string ContentText(const Blob& blob);

// A value as it would be written in a job file.
std::string ValueText(const proto::Value& value);

}  // namespace cairn::cli
