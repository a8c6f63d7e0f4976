// What a coordinator finds in its store when it starts.
#pragma once

#include <vector>

#include "coordinator/blob_files.h"
#include "coordinator/events.h"
#include "coordinator/job_table.h"
#include "coordinator/log.h"
#include "coordinator/store_folder.h"

namespace cairn::coordinator {

// Who has the inputs of jobs: the store, or whoever starts a private run, who brings them along each time.
enum class InputsOf { kStore, kUser };

// The last good checkpoint of every job, in the order of submission. A damaged one, or one whose blobs are
// missing or damaged, is named, renamed to FILE.damaged, and the one before is taken. Blobs that none of the
// kept checkpoints names, and leftovers of interrupted writes, are removed.
std::vector<RestoreJob> Recover(const StoreFolder& folder, BlobFiles& files, InputsOf inputs,
                                const JobLogSink& log);

// The job table; one that cannot be read is set aside and begun anew.
Result<JobTable> OpenJobTable(const StoreFolder& folder, const LogSink& log);

}  // namespace cairn::coordinator
