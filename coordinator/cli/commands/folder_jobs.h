// Whether the results that lie in one folder are of one job: a folder that was filled by hand, or by two
// runs, looks like that of one.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::cli {

// By which the results of a job, and what there is to see of one that runs, are told from those of another,
// wherever either ran; empty: it does not say.
std::string JobOf(const Blob& result);

// One sentence where `path` is a folder and the results right in it are of several jobs, with the files of
// each and whether their inputs are the same; else empty. A file that does not say its job, or cannot be
// read, counts for none.
std::string SeveralJobs(const std::string& path);

// Says so on stderr, and what a command makes of it: "it is x.h5 that is scored".
void WarnOfSeveralJobs(const std::string& path, const std::string& what);

}  // namespace cairn::cli
