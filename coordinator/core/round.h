// The tasks of one barrier: which wait, which are ready, which are under way, which are done. RUN tasks of a
// round, or the one START or ADVANCE task that plans the next. Knows no workers and no clock.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/blob_ledger.h"
#include "schema/hash.h"
#include "schema/job.pb.h"
#include "schema/wire.pb.h"

namespace cairn::coordinator {

enum class TaskStatus {
  kWaiting,  // for partials of earlier tasks
  kReady,    // may be given to a worker
  kRunning,  // at least one attempt is under way
  kDone,
};

struct Attempt {
  std::uint32_t number = 0;
  std::uint64_t worker = 0;  // whose it is, for whoever began it
};

struct TaskRecord {
  // Fixed by the plan.
  std::uint64_t cost = 1;                // at least 1
  std::vector<std::uint32_t> followers;  // tasks that read this one's partial
  std::vector<Hash> parts;               // of blobs, that it reads (schema/blob_part.h)
  double chain = 0;                      // cost of the longest chain of tasks that begins with this one
  // How it stands.
  TaskStatus status = TaskStatus::kWaiting;
  std::uint32_t waits_for = 0;         // partials not yet known
  std::uint32_t attempts = 0;          // begun, ever; the next is numbered attempts + 1
  std::vector<Attempt> live_attempts;  // those under way, numbers ascending
  int failures = 0;
  std::vector<std::uint64_t> failed_at;  // whose those were, for whoever counted them
  int excuses = 0;                       // attempts that were lost, and are not counted as failures
  // What came of it.
  Hash partial;  // RUN only
};

class Round {
 public:
  Round() = default;
  // A round of RUN tasks; `step` must have passed CheckStep.
  static Round OfTasks(const proto::Step& step);
  // A single START or ADVANCE task.
  static Round OfPlan(wire::TaskKey::Kind kind);

  wire::TaskKey::Kind kind() const { return kind_; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(tasks_.size()); }
  std::uint32_t done_count() const { return share(TaskStatus::kDone).tasks; }
  bool AllDone() const { return done_count() == size(); }
  struct Share {
    std::uint32_t tasks = 0;
    double cost = 0;
  };
  const Share& share(TaskStatus status) const { return shares_.at(static_cast<std::size_t>(status)); }
  double cost() const { return cost_; }    // of all tasks
  double chain() const { return chain_; }  // of the longest chain of tasks that wait for each other
  const TaskRecord& task(std::uint32_t index) const { return tasks_.at(index); }

  bool HasReady() const { return !ready_.empty(); }
  // The most costly ready task, of equals the first: long ones early keep the round's end short.
  std::uint32_t NextReady() const;
  std::vector<std::uint32_t> FirstReady(std::size_t most) const;  // that one and those after it

  // Begins an attempt (of a ready task, or one more of a running one) and returns its number.
  std::uint32_t Begin(std::uint32_t index, std::uint64_t worker);
  // Ends one without an answer. True where it was under way; the task is ready again where no other attempt
  // is.
  bool Withdraw(std::uint32_t index, std::uint32_t attempt);
  // Counts a failure at `worker` against the task and returns how many it has.
  int Blame(std::uint32_t index, std::uint64_t worker);
  // An attempt was lost with a connection, and its worker is back: no failure of the task. False where that
  // was said of it too often to be believed.
  bool Excuse(std::uint32_t index);
  // The same of an attempt that was counted as a failure.
  bool TakeBack(std::uint32_t index);
  // The first answer. The task must not be done. Followers whose last input this was become ready.
  void Finish(std::uint32_t index, const Hash& partial);

 private:
  void Move(TaskRecord& task, std::uint32_t index,
            TaskStatus status);  // the one place where a status changes
  void CountAsWaiting(const TaskRecord& task);

  wire::TaskKey::Kind kind_ = wire::TaskKey::START;
  std::vector<TaskRecord> tasks_;
  std::set<std::pair<std::uint64_t, std::uint32_t>> ready_;  // {~cost, index}
  std::array<Share, 4> shares_;                              // by status
  double cost_ = 0, chain_ = 0;
};

// What is wrong with a step's form, for people; empty where nothing is: task indices in order, inputs that
// name earlier tasks only, hashes of the right length.
std::string CheckStep(const proto::Step& step);

// The blobs that a step names: of its state, its tasks' inputs, its result.
HashSet BlobsOfStep(const proto::Step& step);

// Over a message's bytes with maps in the order of their keys: equal messages, equal hashes (within one
// build).
Hash HashOfMessage(const google::protobuf::Message& message);
// Equal where two answers to one task agree.
inline Hash HashOfStep(const proto::Step& step) { return HashOfMessage(step); }

}  // namespace cairn::coordinator
