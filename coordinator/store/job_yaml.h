// A resolved job as the YAML of a job file: what `cairn run` would take, and what people read in a result.
#pragma once

#include <string>

#include "schema/job.pb.h"

namespace cairn::coordinator {

std::string JobAsYaml(const proto::Job& job);

}  // namespace cairn::coordinator
