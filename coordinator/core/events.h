// What goes into the core and what comes out of it. The shell turns messages, files and the clock into
// events, and carries out actions in their order.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "schema/checkpoint.pb.h"
#include "schema/hash.h"
#include "schema/job.pb.h"
#include "schema/wire.pb.h"
#include "schema/wire/refusal.h"

namespace cairn::coordinator {

// ---- events: workers ----
struct WorkerHello {
  std::string peer;
  wire::Hello hello;
};
struct WorkerHeartbeat {
  std::string peer;
  wire::Heartbeat heartbeat;
};
// It leaves of its own accord: nobody is to blame for its tasks.
struct WorkerLeave {
  std::string peer;
};
// The shell knows that its connection is gone, sooner than its lease would tell. `ended`: also that its
// process is.
struct WorkerLost {
  std::string peer;
  bool ended = false;
};
// It leaves once what it runs is done: told by its owner, or by itself. Repeated, it changes nothing.
struct DrainWorker {
  std::string peer;
};
struct TaskDone {
  std::string peer;
  wire::Done done;
  std::vector<Hash> blobs;  // that came with it; the shell has them
  std::string wrong = {};   // why one of them is none that can be kept
};
struct TaskFailed {
  std::string peer;
  wire::Failed failed;
};

// ---- events: jobs ----

// `asker` waits for an Answer, which comes once what he asked for is durable. Where it cannot be made durable
// he is refused, and it is taken back: a job is as if he had never asked. Empty: nobody waits, and nothing is
// taken back.

// The shell has all of job.input_blobs. Where `id` is there already, it was told twice.
struct SubmitJob {
  std::string id;
  proto::Job job;
  std::vector<Hash> blobs;  // that came with it
  std::string asker = {};
  std::string owner = {};  // whose it is; of one that is told twice its first owner stays
};
// A command that the job's state does not allow (job_commands.h) changes nothing.
struct PauseJob {
  std::string id;
  std::string asker = {};
  std::string by = {};  // who that is, for people, where it is not the job's owner
};
struct ResumeJob {
  std::string id;
  std::string asker = {};
};
struct CancelJob {
  std::string id;
  std::string asker = {};
};
struct RetryJob {
  std::string id;
  std::string asker = {};
};
struct DeleteJob {
  std::string id;
  std::string asker = {};
};
struct PrioritizeJob {
  std::string id;
  int priority = 0;
  std::string asker = {};
};
// For how long the store has been served, in all, by coordinators before: once, before any RestoreJob.
struct Served {
  double seconds = 0;
};
// Rebuilds a job from its last good checkpoint. The shell has all blobs that it names.
struct RestoreJob {
  proto::Checkpoint checkpoint;
  std::vector<Hash> previous_blobs;  // of the checkpoint before it, those that are there: kept too
};

// ---- events: disk and clock ----
struct PersistDone {
  std::string job;
  std::uint64_t number = 0;
};
struct PersistFailed {
  std::string job;
  std::uint64_t number = 0;
  std::string reason;
};
// What came of a ForgetJob: the disk has nothing of the job any more, or all that it had.
struct ForgetDone {
  std::string job;
};
struct ForgetFailed {
  std::string job;
  std::string reason;
};
// Checkpoints that wait for their interval are wanted now: the service is about to end.
struct SaveNow {};
struct Tick {
  bool behind =
      false;  // messages have come that were not read yet: who seems slow or silent may be among them
};

using Event =
    std::variant<WorkerHello, WorkerHeartbeat, WorkerLeave, WorkerLost, DrainWorker, TaskDone, TaskFailed,
                 SubmitJob, PauseJob, ResumeJob, CancelJob, RetryJob, DeleteJob, PrioritizeJob, Served,
                 RestoreJob, PersistDone, PersistFailed, ForgetDone, ForgetFailed, SaveNow, Tick>;

// ---- actions ----

// To a worker: Welcome, Refuse, UnknownWorker, Assign, Cancel, Drain.
struct Send {
  std::string peer;
  wire::Envelope message;
};
struct Publish {
  std::uint32_t stage = 0;
  Hash result;
};
// Make the blobs durable, then the results, then the checkpoint; answer with PersistDone or PersistFailed. At
// most one of a job is under way at any time. Checkpoint n durable: those before n - 1 may go.
struct Persist {
  proto::Checkpoint checkpoint;
  std::vector<Publish> publish;
};
// Nobody needs these any more, in memory or on disk.
struct DropBlobs {
  std::vector<Hash> hashes;
};
// All that the disk has of the job goes, after what was asked for before; answer with ForgetDone or
// ForgetFailed.
struct ForgetJob {
  std::string job;
};
// To whoever asked for something of a job: it is durable, or, with the reason, was refused.
struct Answer {
  std::string asker;
  std::string job;
  std::string refusal;  // empty: it is durable
  bool known = false;   // of a submission: the job was there before
  bool unable = false;  // of a refusal: for what the service lacks, not for what was asked
};
// A job came, is about to go or is gone, its state changed, or it came a round further.
struct JobChanged {
  std::string job;
};
// A line for people, about a job or, where none is named, about the service. kAlarm: a bug that must not go
// unseen, such as two answers to one task that differ.
struct Report {
  enum Level { kInfo, kWarning, kAlarm };
  Level level = kInfo;
  std::string job;
  std::string text;
};

// A worker said what it may not; nothing came of it.
struct Refused {
  std::string peer;
  wire::Refusal refusal;
};

using Action = std::variant<Send, Persist, DropBlobs, ForgetJob, Answer, JobChanged, Report, Refused>;

}  // namespace cairn::coordinator
