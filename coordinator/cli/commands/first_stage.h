// The plan of a job's first stage. What is wrong with its options and its inputs together only the pipeline
// knows.
#pragma once

#include <atomic>
#include <map>
#include <string>

#include "coordinator/cli/job_file/job_file.h"
#include "coordinator/local/embedded.h"
#include "schema/blob.h"

namespace cairn::cli {

// Plans it as a real run would, on a worker of its own, in a folder that is gone afterwards.
// Throws InputError or WorldError where there is no place for it.
coordinator::EmbeddedResult PlanFirstStage(const proto::Job& job,
                                           const std::map<std::string, BlobPtr>& inputs,
                                           const std::atomic<bool>& stop);

// Throws InputError of a job whose first stage the pipeline refuses, so that it need not be sent away to hear
// it, and of inputs that cannot be read or are in doubt. Where they hold more than 16 MiB no plan is made.
void CheckFirstStage(ParsedJob parsed, bool units_are_right);

}  // namespace cairn::cli
