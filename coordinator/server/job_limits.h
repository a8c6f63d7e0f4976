// What a job may not be larger than, whatever it says.
#pragma once

#include <string>

#include "schema/job.pb.h"
#include "schema/wire/limits.h"

namespace cairn::coordinator {

// What is over a limit, for people; empty where nothing is.
std::string CheckLimits(const proto::Job& job, const wire::JobLimits& limits);

}  // namespace cairn::coordinator
