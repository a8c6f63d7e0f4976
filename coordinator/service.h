// A coordinator for many machines: `cairn coordinator --store DIR --listen ENDPOINT`.
//
// Store:  DIR/lock                        flock'ed while a coordinator serves
//         DIR/jobs.sqlite                 job table (WAL); rebuilt from the checkpoints where it is lost
//         DIR/blobs/<hash>.h5             blobs that checkpoints name
//         DIR/checkpoints/<job>/<n>.h5    the last two of every unfinished job, the last one of an ended job
//         DIR/results/<job>/<stage>.h5    results, published whole
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "schema/error.h"

namespace cairn::coordinator {

struct ServiceOptions {
  std::string store_dir;  // made where it does not exist
  std::string listen;     // ipc://PATH (its folder must be 0700), or tcp://HOST:PORT with keys only
  std::string keys_dir;   // CURVE keys and allow-list for tcp; empty: none
  double checkpoint_interval_s = 1;  // at most one checkpoint of a job in this time, and one at a stage's end
  std::uint64_t memory_bytes = 4ull << 30;  // blobs beyond this are kept on disk only
};

// A line for people about what happens: a worker joined or was refused, a task is tried again, a job ended.
enum class Severity { kInfo, kWarning, kError };
using LogSink = std::function<void(Severity, const std::string& line)>;

// Serves until `stop`, then writes checkpoints, tells the workers Bye and returns within 2 s; unfinished jobs
// go on with the next start. kBusy: another coordinator has DIR. kRefused: tcp without keys. Clients speak
// wire.proto:
//   Have      -> Reply.missing: which of these blobs to send along
//   Submit    -> Reply.jobs[0], once the job is durable; not ok where an input blob is missing or the job is
//   bad JobQuery  -> Reply.jobs. action "" or status: as it stands; cancel: ends it, its last checkpoint
//   stays;
//                resume: goes on from there (paused, cancelled or failed); results: blobs by stage name,
//                those done
Status Serve(const ServiceOptions& options, const LogSink& log, const std::atomic<bool>& stop);

}  // namespace cairn::coordinator
