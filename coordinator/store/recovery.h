// What a coordinator finds in its store when it starts.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "coordinator/core/events.h"
#include "coordinator/store/blob_files.h"
#include "coordinator/store/folder.h"
#include "coordinator/store/job_table.h"
#include "coordinator/store/log.h"

namespace cairn::coordinator {

// Who has the inputs of jobs: the store, or whoever starts a private run, who brings them along each time.
enum class InputsOf { kStore, kUser };

struct PublishedFiles {
  std::function<std::vector<std::filesystem::path>(const std::string& job)>
      of;               // its results; none: nobody knows
  double served_s = 0;  // for how long the store has been served, in all: what is recovered ended no earlier
};

// The last good checkpoint of every job, in the order of submission. A damaged one, or one whose blobs are
// missing or damaged, is named, renamed to FILE.damaged, and the one before is taken. Blobs that none of the
// kept checkpoints names, and leftovers of interrupted writes, are removed, unless a checkpoint was not good.
// A job whose input is missing or damaged has failed. One that has lost its checkpoints is named, and blobs
// stay that it may need.
// A job of which no checkpoint can be read, but whose results are all there and whole, is done: its record is
// made of them, and written. Throws UnreadableStore where a checkpoint or a blob that one names cannot be
// read and may be whole.
std::vector<RestoreJob> Recover(const StoreFolder& folder, BlobFiles& files, InputsOf inputs,
                                const PublishedFiles& published, const JobLogSink& log);

// Jobs that have a log, but no checkpoint that could be read: what is deleted loses its log first. Another
// process may serve the store. Where the job table cannot be read, nobody knows.
Result<std::vector<std::string>> LostJobs(const StoreFolder& folder);
// Whether its table has the logs of all jobs that were not deleted: it is there, and none was quarantined.
bool KnowsItsLogs(const StoreFolder& folder);
std::string WhyLost(const StoreFolder& folder,
                    const std::string& job);  // a sentence that begins with the job

// What a look through a store finds, a sentence each, for people.
struct StoreFindings {
  std::size_t jobs = 0;
  std::vector<std::string>
      damaged;  // checkpoints, blobs that the newest ones need, results of jobs that are done
  std::vector<std::string> orphaned;   // jobs of which nothing but all their results is there, whole
  std::vector<std::string> unclaimed;  // folders of results that are none of these, and no job's
};
// Reads every job's newest checkpoint, the blobs that it names, and the results below `results`. Changes
// nothing, but that a damaged pack of blobs is quarantined, as each start does, and that with `adopt` what is
// orphaned becomes a job again that is done, without an owner: the next start shows it. Nothing becomes one
// through a link, nor where another job, or another such folder, has its number.
StoreFindings CheckStore(const StoreFolder& folder, const std::filesystem::path& results, bool adopt);

// The job table; one that cannot be read is quarantined and begun anew.
Result<JobTable> OpenJobTable(const StoreFolder& folder, const LogSink& log);

}  // namespace cairn::coordinator
