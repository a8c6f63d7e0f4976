// A job of one stage, as `cairn run PIPELINE LOG --set key=value …` says it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coordinator/cli/catalog.h"
#include "coordinator/cli/job_file.h"

namespace cairn::cli {

// The stage and the job have the pipeline's name. Throws InputError that names the argument and what is
// allowed.
ParsedJob MakeJob(const std::string& pipeline_name, const std::string& log,
                  const std::vector<std::string>& settings, std::uint64_t seed, const Catalog& catalog);

}  // namespace cairn::cli
