// What a job would do, for --dry-run.
#pragma once

#include <map>
#include <string>

#include "coordinator/cli/catalog.h"
#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn::cli {

// Inputs with their sizes, then the stages with every option, given or default.
std::string PlanText(const proto::Job& job, const std::map<std::string, BlobPtr>& inputs,
                     const Catalog& catalog);

// One line about a log: "2 robots, 2000 controls, 130 observations". Empty for another kind of file.
std::string LogText(const Blob& blob);

// A value as it would be written in a job file.
std::string ValueText(const proto::Value& value);

}  // namespace cairn::cli
