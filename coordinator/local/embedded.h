// A private coordinator with its own workers, for `cairn run`: over ipc in a folder of mode 0700, nobody else
// joins.
//
// DIR/<stage>.h5 are the results, each published whole when its stage ends; DIR/.cairn is the store
// (server/service.h).
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "coordinator/store/log.h"
#include "schema/blob.h"
#include "schema/wire.pb.h"

namespace cairn::coordinator {

struct EmbeddedOptions {
  std::string dir;             // --out; made where it does not exist, locked while the run lasts
  int workers = 1;             // processes, at least 1
  std::string worker_program;  // path of cairn-worker
  bool force = false;          // forget an earlier run in dir; its results go when this one has its first
  std::vector<std::string> input_files;  // which not even `force` may remove: kInputError
  bool plan_only = false;  // stop when the first stage is planned (kStopped): info.note says what it found
  double checkpoint_interval_s = 0.5;   // its workers compute for more than a second in one
  std::uint64_t checkpoint_rounds = 0;  // one every so many rounds instead; 0: by the interval
  double save_patience_s = 1.2;         // that a stopped run waits for its last save: Ctrl-C ends within 2 s
  std::uint64_t task_memory_mb = 0;  // that a task may take, whatever the job says; 0: the job's limit alone
  LogSink log;                       // may be empty
  // Called with the endpoint at which clients may ask, once the job is there. May be empty, and may throw.
  std::function<void(const std::string&)> when_listening;
  // Called once the run is done (kDone, kAlreadyDone), while the folder is still this run's alone: for what
  // is written beside the results. May be empty, and may throw.
  std::function<void(const struct EmbeddedResult&)> when_done;
};

enum class EmbeddedEnd {
  kDone,         // exit 0: all results are in dir
  kAlreadyDone,  // exit 0: an earlier run of the same job did it; nothing was run
  kFailed,       // exit 1: the job failed through no fault of its input; `reason`
  kInputError,   // exit 2: the job's input is bad, or dir no place to write to; `reason` says which
  kConflict,  // exit 2: dir holds a run of another job or inputs, or of another build; force starts anew. (A
              // run that ended for bad input without a result is in nobody's way.)
  kBusy,      // exit 2: another process has dir
  kStopped,   // `stop` was set; the same run again resumes
  kPaused,    // exit 1: cannot save (a full disk); `reason`; the same run again resumes
};

struct EmbeddedResult {
  EmbeddedEnd end = EmbeddedEnd::kFailed;
  std::string reason;                          // empty for kDone
  std::map<std::string, std::string> results;  // stage name -> path of its file, those that are done
  wire::JobInfo info;                          // as it stood at the end
  std::map<std::string, double> expected;      // plan_only: the plan's figures expected/NAME, by NAME
  bool resumed = false;                        // an earlier run's checkpoint was used
};

struct EmbeddedProgress {
  wire::JobInfo info;
  unsigned workers = 0;  // connected
};

// Runs `job` to its end. `inputs`: by the names of job.inputs; truth must have been left behind by the
// caller. `on_progress` is called on the calling thread, at most ten times a second; keep it short. Once
// `stop` is true the run saves a checkpoint, ends its workers and returns within 2 s. Workers are killed with
// this process, however it ends; one that dies is started again, at most 5 times a worker and then the run
// fails.
EmbeddedResult RunEmbedded(const EmbeddedOptions& options, proto::Job job,
                           const std::map<std::string, BlobPtr>& inputs,
                           const std::function<void(const EmbeddedProgress&)>& on_progress,
                           const std::atomic<bool>& stop);

}  // namespace cairn::coordinator
