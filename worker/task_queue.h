// The task queue between the thread that talks to the coordinator and the thread that computes. Tasks lie
// here in the order in which they came and are computed in that order; their inputs arrive while they wait,
// so that the computing thread rarely does. One mutex guards all of it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "schema/hash.h"
#include "schema/wire/codec.h"

namespace cairn::worker {

struct AssignedTask {
  explicit AssignedTask(wire::Assign a) : assign(std::move(a)) {}

  const wire::Assign assign;
  std::atomic<std::uint64_t> ticks{0};
  std::atomic<bool> cancelled{false};

  // All below: guarded by the task queue, fixed once the task is ready unless said otherwise.
  std::map<Hash, BlobPtr> blobs;          // inputs that have come; of parts by their names
  std::set<Hash> lacking;                 // inputs that have not
  std::string failure;                    // why it cannot be computed; grows at any time
  std::vector<Hash> partials;             // ADVANCE: in task order, fetched a few ahead of the reader
  std::map<Hash, int> partial_uses;       // at any time: how often each is still to be read
  std::map<Hash, BlobPtr> partial_blobs;  // at any time: those that have come and are still to be read
  std::set<Hash> partials_asked;          // at any time: those on their way
};
using TaskPtr = std::shared_ptr<AssignedTask>;

// A part of a blob.
struct PartOf {
  Hash blob;
  proto::BlobPart part;
};

// A blob that a task needs, or a part of one. Inputs are worth keeping for other tasks; a partial is read
// once.
struct Want {
  Hash hash;  // of a part: its name (schema/blob_part.h)
  bool keep = true;
  std::optional<PartOf> part = {};
};

class TaskQueue {
 public:
  // `wake` is called, on the computing thread, when there is something to send or to fetch.
  explicit TaskQueue(std::function<void()> wake) : wake_(std::move(wake)) {}

  // ---- for the thread that talks ----
  void Add(wire::Assign assign);
  void Cancel(const wire::TaskKey& key);  // unknown keys are ignored
  void DropAll();                         // as if all were cancelled, and answers not yet taken too
  void Deliver(const wire::NamedBlob& named);
  void NoteArrival();  // some of what its tasks wait for has come, and is not whole yet
  // The coordinator does not have it, or, where it has the blob, says why it has no such part.
  void GiveUp(const Hash& hash, const std::string& why = {});
  std::optional<Want> TakeWant();  // the next that was not taken before, in the order of need
  std::vector<wire::Message> TakeAnswers();
  wire::Heartbeat Assigned() const;  // running and waiting tasks with their ticks
  bool Empty() const;                // no task that is still wanted is assigned, and no answer waits
  std::size_t Count() const;         // tasks that are assigned and still wanted, and answers that wait
  void Close();                      // Next returns null from now on; what runs is cancelled

  // ---- for the thread that computes ----
  TaskPtr Next();  // waits for the first task to be ready; null: closed
  std::string FailureOf(const AssignedTask& task) const;  // why it cannot be computed; empty: it can
  // Both wait.
  // Throw Cancelled, or runtime_error where the coordinator does not have it.
  BlobPtr AwaitInput(AssignedTask& task, Want want);
  BlobPtr AwaitPartial(AssignedTask& task, std::size_t index);
  // The task leaves the queue; its answer goes out unless it was cancelled.
  void Finish(const AssignedTask& task, wire::Message answer);

 private:
  using Lock = std::unique_lock<std::mutex>;
  void WantInputs(const TaskPtr& task, const std::vector<Want>& inputs);
  void WantPartials(const TaskPtr& task, std::size_t first);
  void WantOne(const TaskPtr& task, Want want);
  void Forget(const TaskPtr& task);

  const std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  std::deque<TaskPtr> queue_;
  TaskPtr running_;
  std::map<Hash, std::vector<TaskPtr>> waiting_;  // blobs that have not come -> who needs them
  std::deque<Want> wants_;
  std::vector<wire::Message> answers_;
};

}  // namespace cairn::worker
