// A coordinator for many machines: `cairn coordinator --store DIR --listen ENDPOINT`.
//
// Store:  DIR/lock                        flock'ed while a coordinator serves
//         DIR/holder                      which coordinator that is, for other machines (store/holder.h)
//         DIR/version                     of the store, a number
//         DIR/id                          which store it is, whatever DIR is called (store/store_id.h)
//         DIR/served                      for how long it was served, in all (store/served_file.h)
//         DIR/jobs.sqlite                 jobs' logs and the highest number of one (WAL); begun anew where it
//                                         is lost
//         DIR/blobs/<hash>.h5             a blob that checkpoints name
//         DIR/blobs/pack-<hash>.h5        many small ones in one
//         DIR/blobs/<hash>.flat           an input, as it was uploaded
//         DIR/uploads/<n>.part            inputs that are on their way; gone with the next start
//         DIR/checkpoints/<job>/<n>.h5    the last two of every job, one of a job that is done
//         DIR/results/<job>/<stage>.h5    results, published whole
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "coordinator/store/log.h"
#include "schema/error.h"
#include "schema/wire.pb.h"
#include "schema/wire/allow_list.h"
#include "schema/wire/socket.h"

namespace cairn::coordinator {

struct ServiceOptions {
  std::string store_dir;  // made where it does not exist
  std::string listen;     // ipc://PATH (its folder must be 0700), or tcp://HOST:PORT with keys only
  std::string keys_dir;   // for tcp: coordinator.key (`cairn keys new`) and allowed, who may do what
  wire::SocketOptions sockets;
  wire::KeyLimits key_limits;           // of keys of which the list says nothing else, but administrators'
  std::uint64_t checkpoint_rounds = 0;  // one every so many rounds instead; 0: by the interval
  double checkpoint_interval_s = 1;  // at most one checkpoint of a job in this time, and one at a stage's end
  std::uint64_t store_limit_bytes = 0;      // that the store may take on disk; 0: no limit
  double keep_s = 0;                        // a job goes when it has ended for longer; 0: never
  double task_time_s = 0;                   // of a task whose job says nothing; 0: no limit
  std::uint64_t task_memory_mb = 0;         // the same
  std::uint64_t memory_bytes = 0;           // as of ServerOptions
  std::uint64_t sent_bytes = 256ull << 20;  // that clients have yet to read
  bool take_over = false;  // the store, also where another machine's coordinator did not give it back
  bool drain = false;      // takes no new jobs, and ends once none runs
  std::function<void(const wire::JobInfo& job)> job_ended;  // of Server; it must not wait for anything
  std::string metrics;  // where (metrics_port.h) it shows its metrics; empty: nowhere
};

// Serves until `stop`, or, where it drains, until all jobs have ended or are paused; then writes checkpoints,
// sends the workers Leave and returns within 2 s; unfinished jobs go on with the next start. Tells the
// service manager, where one asks, how it stands. kBusy: another coordinator has DIR, takes it over
// meanwhile, or has the address.
// kRefused: tcp without keys.
//
// What clients ask (wire.proto) and are answered:
//   Have: Reply.missing, the blobs that must be sent along.
//   Offer, Piece: an upload (core/uploads.h); Credit, and Reply once the blob is durable or refused.
//   Submit: Reply.jobs[0], once the job is durable. Not ok where an input blob is missing (Reply.missing),
//     the job is bad, or it cannot be saved: then the service has no such job. The same job and inputs again,
//     unless that has failed or was cancelled: that job, and Reply.known.
//   JobQuery: Reply.jobs, of one job or all, after the action: "" or status; pause, resume, cancel, retry,
//     delete and priority (README.md says what each does in which state), once that is durable (not ok where
//     it cannot be saved: then it is as it was before); results, those done: blobs, by stage name in `names`,
//     each with its `provenance/`, where `provenance/kind` says what kind of file it is; so_far, in the same
//     way, what there is to see of the stage under way (State.so_far); inputs, by their names, to whose job
//     it is, until it is done or cancelled.
Status Serve(const ServiceOptions& options, const LogSink& log, const std::atomic<bool>& stop);

}  // namespace cairn::coordinator
