// Reads the inputs of a job. Ground truth is left behind here: nothing that runs a pipeline ever holds it.
#pragma once

#include <map>
#include <string>

#include "coordinator/cli/job_file/job_file.h"
#include "coordinator/client.h"
#include "schema/blob.h"

namespace cairn::cli {

// By the names of job.inputs; fills in job.input_blobs.
// Throws InputError that begins with where the input is named; refuses a log of what no robot does, unless
// `units_are_right`.
std::map<std::string, BlobPtr> ReadJobInputs(ParsedJob& parsed, bool units_are_right);
// The same of inputs that are sent away: they are looked at in a child process, which alone holds them, and
// read again, in parts, while they are sent.
std::map<std::string, coordinator::Input> LookAtJobInputs(ParsedJob& parsed, bool units_are_right);

// Throws InputError of all that is in doubt, and says what to do. `where`: "the log: log.h5: ", or nothing.
[[noreturn]] void CheckUnits(const std::string& where, const std::vector<std::string>& doubts);

}  // namespace cairn::cli
