// Reads the inputs of a job. Ground truth is left behind here: nothing that runs a pipeline ever holds it.
#pragma once

#include <map>
#include <string>

#include "coordinator/cli/job_file.h"
#include "schema/blob.h"

namespace cairn::cli {

// By the names of job.inputs; fills in job.input_blobs. Throws InputError that begins with where the input is
// named.
std::map<std::string, BlobPtr> ReadJobInputs(ParsedJob& parsed);

}  // namespace cairn::cli
