// One job as the core sees it: where it stands in its chain of stages, the round under way, and what is saved
// of it.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "coordinator/core/blob_ledger.h"
#include "coordinator/core/eta.h"
#include "coordinator/core/events.h"
#include "coordinator/core/round.h"

namespace cairn::coordinator {

// Checkpoints of a job: the next is always made of the job as it stands, so that there is no queue of them.
struct Saving {
  std::uint64_t number = 0;  // of the last one begun
  bool durable = false;      // one is
  bool under_way = false;
  bool due = false;                            // something came since the last one
  bool at_once = false;                        // do not wait for the interval
  double last_s = 0;                           // when the last one was begun
  std::uint64_t rounds = 0;                    // that began since then
  double not_before_s = 0;                     // the last one failed: the next is not tried earlier
  bool with_partials = false;                  // the round under way is saved with the partials that it has
  std::vector<Publish> unpublished;            // results that no durable checkpoint covers yet
  std::size_t publishing = 0;                  // the first so many of them go with the one under way
  proto::JobState saves = proto::JOB_RUNNING;  // what the last one begun says of the job
};

// What a job's owner may change of it.
struct Standing {
  proto::JobState state = proto::JOB_RUNNING;
  std::string reason;
  bool input_error = false;
  bool held = false;
  int priority = 0;
  std::vector<std::string> failures;
  double ended_served_s = 0;
};

// A command that is not durable yet.
struct PendingCommand {
  std::string asker;         // who waits for it
  std::uint64_t number = 0;  // of the first checkpoint that holds it
  Standing before;           // to be taken back to, where that one fails
  bool known = false;        // it is a submission that was told twice
};

// An attempt that was dispatched, and to whom.
struct GivenAttempt {
  std::uint32_t stage = 0;
  std::uint64_t round = 0;
  wire::TaskKey::Kind kind = wire::TaskKey::RUN;
  std::uint32_t task = 0, attempt = 0;
  std::string peer;
  bool operator==(const GivenAttempt&) const = default;
};
// Of one round nearly all, whose tasks differ.
struct HashOfAttempt {
  std::size_t operator()(const GivenAttempt& attempt) const {
    constexpr std::size_t kOdd = 0x9E3779B97F4A7C15;
    return (attempt.task + kOdd * attempt.attempt + attempt.round) * kOdd;
  }
};

// What tasks took that are done, to guess what others will take.
struct Pace {
  double seconds = 0;
  double cost = 0;

  double Expect(double of_cost) const { return cost > 0 ? seconds / cost * of_cost : 1; }
};

// Who was given a task last that reads a part of a blob, of the round under way and of the one before: so
// tasks that read the same rows in one round after the other go where these are.
struct PartPlaces {
  std::map<Hash, std::uint64_t> now, before;  // number of a worker, by the part's name

  void Note(const Hash& part, std::uint64_t worker) { now[part] = worker; }
  std::uint64_t WorkerOf(const Hash& part) const;  // 0: nobody
  void BeginRound() { before = std::exchange(now, {}); }
};

// Blobs that a job keeps alive, by reason.
struct Holds {
  BlobLedger::Hold inputs, results, step, partials, saving, saved, saved_before;
};

struct Job {
  // Fixed when it is submitted.
  std::string id;
  std::uint64_t order = 0;
  proto::Job spec;
  Hash hash;          // of it: HashOfJob
  std::string owner;  // who may command it, beside administrators; empty: they alone
  // How it stands.
  proto::JobState state = proto::JOB_RUNNING;
  std::string reason;
  bool input_error = false;
  bool held = false;  // paused by its owner, or an administrator: stays so, and is saved
  std::uint32_t stage = 0;
  std::uint64_t round = 0;
  std::optional<proto::Step> step;   // that planned `round`; none: the stage's START is due
  Round tasks;                       // under way: START, RUN or ADVANCE
  std::vector<Hash> partials;        // of `round`, by task; empty hashes where not yet known
  std::vector<Hash> results;         // of finished stages
  std::optional<wire::Build> build;  // of the workers that did what is done
  Saving saving;
  std::deque<PendingCommand> pending;  // by number
  bool leaving = false;                // it is being deleted
  std::vector<std::string> deleters;   // who wait for that
  Holds holds;
  // Of the round under way and of the last START or ADVANCE: nobody else's answer counts.
  std::unordered_set<GivenAttempt, HashOfAttempt> given;
  // Workers whose answer was malformed: they get no more of its tasks where there are others.
  std::set<std::uint64_t> excluded;
  // A second answer to the last START or ADVANCE is checked against this.
  wire::TaskKey last_plan;
  Hash last_plan_hash;
  // For people and for placement; no result depends on it.
  std::vector<proto::StageFacts> facts;
  std::vector<std::string> failures;  // the last few
  PartPlaces parts;
  std::deque<double> task_seconds;  // of this round's last answers
  Pace run_pace, plan_pace;         // of this stage's RUN tasks; of every START and ADVANCE, each of cost 1
  Eta eta;                          // of this stage
  double round_since_s = 0;
  double running_since_s = 0;
  double seconds_before = 0;
  double ended_served_s = 0;  // Core::served_s when it ended

  void SetSpec(const proto::Job& job);
  bool Running() const { return state == proto::JOB_RUNNING; }
  bool Ended() const { return state != proto::JOB_RUNNING && state != proto::JOB_PAUSED; }
  // Nothing but its record is needed any more.
  bool Final() const { return state == proto::JOB_DONE || state == proto::JOB_CANCELLED; }
  // It could not be saved: the next try is when it is resumed, or told anything else.
  bool SavingWaits() const { return state == proto::JOB_PAUSED && !held && pending.empty(); }
  std::uint32_t StageCount() const { return static_cast<std::uint32_t>(spec.stages_size()); }
  bool AllStagesDone() const { return stage == StageCount(); }
  // What people may look at of the stage under way (State.so_far).
  std::optional<Hash> SoFar() const;
  const proto::Stage& CurrentStage() const { return spec.stages(static_cast<int>(stage)); }
  // Key of an attempt at a task of what is under way.
  wire::TaskKey Key(std::uint32_t task, std::uint32_t attempt) const;
  void NoteGiven(const wire::TaskKey& key, const std::string& peer);
  bool WasGiven(const wire::TaskKey& key, const std::string& peer) const;
  void ForgetGivenBut(const wire::TaskKey& plan);  // all attempts at other tasks
  // Whether it names a task of what is under way, whatever the attempt.
  bool IsUnderWay(const wire::TaskKey& key) const;
  // "task 3 (forward) of round 5 of stage 'landmarks'"
  std::string TaskName(std::uint32_t task) const;
  Standing Stands() const;
  double Seconds(double now_s) const;
  double MedianTaskSeconds() const;  // of this round's last ones; 0 where fewer than three answers are in
  void NoteSeconds(wire::TaskKey::Kind kind, std::uint64_t cost, double seconds);  // of an answer
  double ExpectedSeconds(std::uint32_t task) const;         // of work; 1 where nothing is known yet
  double ExpectedSeconds(const Round::Share& share) const;  // the same of some of the tasks under way
};

inline constexpr int kLowestPriority = -10, kHighestPriority = 10;
inline constexpr std::uint64_t kMostTaskMemory_mb = 1'000'000'000;

// ", at round 5 of stage 'landmarks', which has 3 of its 12 tasks done": where a job goes on.
std::string Whereabouts(const Job& job);

// Whether a job or a stage may have the name: it becomes part of a file's.
bool IsPlainName(const std::string& name);

// What is wrong with a job's chain of stages or its settings, for people; empty where nothing is.
std::string CheckJob(const proto::Job& job);

// Whether a run writes a file of this name beside the folders of its stages.
bool IsFileOfARun(const std::string& name);

// Equal where two jobs compute the same: all but the paths from which the inputs were read, priority and
// limits.
Hash HashOfJob(const proto::Job& job);

// The current stage's inputs, by the pipeline's names for them.
std::map<std::string, Hash> StageInputs(const Job& job);

// The message that hands an attempt to a worker, every input a blob by hash.
wire::Assign MakeAssign(const Job& job, std::uint32_t task, std::uint32_t attempt);

// The blobs that a task reads: where it is placed depends on who has them.
std::vector<Hash> TaskInputs(const Job& job, std::uint32_t task);

const char* StateName(const Job& job);  // "queued"

wire::JobInfo MakeInfo(const Job& job, double now_s);

// What it could put workers to.
wire::Demand DemandOf(const Job& job);

// The job as it stands, with or without the partials of its round; the job itself says when it may be saved.
proto::Checkpoint MakeCheckpoint(const Job& job, double now_s, bool with_partials);

// What a worker says of a failure may be of any length; of a reason so much is kept, told and saved.
std::string CutReason(const std::string& reason);

}  // namespace cairn::coordinator
