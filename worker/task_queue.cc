#include "worker/task_queue.h"

#include <algorithm>
#include <stdexcept>

#include "pipelines/pipeline.h"
#include "schema/blob_part.h"

namespace cairn::worker {
namespace {

// How many partials may be on their way, or wait in memory, ahead of the one that is being read.
constexpr std::size_t kPartialsAhead = 16;

bool SameAttempt(const wire::TaskKey& a, const wire::TaskKey& b) {
  return a.attempt() == b.attempt() && a.task() == b.task() && a.round() == b.round() &&
         a.stage() == b.stage() && a.kind() == b.kind() && a.job() == b.job();
}

// The blobs that must be here before the task can begin; a failure where a hash is none. What a stage is
// given, START and ADVANCE fetch as they come to it: it may be large, and they may need little of it.
std::vector<Want> ListInputs(AssignedTask& task) {
  std::vector<Want> inputs;
  const auto add = [&task](const std::string& binary, auto&& into) {
    const Result<Hash> hash = Hash::FromBinary(binary);
    if (hash.ok())
      into(hash.value());
    else
      task.failure = "a malformed assignment: " + hash.status().message();
  };
  const auto input = [&inputs](const Hash& hash) { inputs.push_back({hash}); };
  std::set<Hash> of_stage;
  for (const auto& [name, hash] : task.assign.inputs())
    add(hash, [&of_stage](const Hash& given) { of_stage.insert(given); });
  for (const auto& [name, hash] : task.assign.state().blobs())
    add(hash, [&](const Hash& blob) {
      if (!of_stage.contains(blob)) input(blob);
    });
  for (const proto::InputRef& ref : task.assign.task().inputs()) {
    add(ref.blob(), [&](const Hash& hash) {
      if (ref.has_part())
        inputs.push_back({NameOfPart(hash, ref.part()), true, PartOf{hash, ref.part()}});
      else
        input(hash);
    });
  }
  for (const std::string& partial : task.assign.partials()) {
    add(partial, [&task](const Hash& hash) {
      task.partials.push_back(hash);
      ++task.partial_uses[hash];
    });
  }
  for (const Want& want : inputs) task.lacking.insert(want.hash);
  return inputs;
}

}  // namespace

void TaskQueue::WantOne(const TaskPtr& task, Want want) {
  std::vector<TaskPtr>& waiters = waiting_[want.hash];
  const bool is_first = waiters.empty();
  if (std::ranges::find(waiters, task) == waiters.end()) waiters.push_back(task);
  if (is_first) wants_.push_back(std::move(want));
}

void TaskQueue::WantInputs(const TaskPtr& task, const std::vector<Want>& inputs) {
  for (const Want& want : inputs) WantOne(task, want);
  WantPartials(task, 0);
}

void TaskQueue::WantPartials(const TaskPtr& task, std::size_t first) {
  const std::size_t end = std::min(first + kPartialsAhead, task->partials.size());
  for (std::size_t i = first; i < end; ++i) {
    const Hash& hash = task->partials[i];
    if (task->partial_blobs.contains(hash) || !task->partials_asked.insert(hash).second) continue;
    WantOne(task, {hash, false});
  }
}

void TaskQueue::Add(wire::Assign assign) {
  auto task = std::make_shared<AssignedTask>(std::move(assign));
  const std::vector<Want> inputs = ListInputs(*task);
  const Lock lock(mutex_);
  if (task->failure.empty()) WantInputs(task, inputs);
  queue_.push_back(std::move(task));
  changed_.notify_all();
}

// Nobody waits for its inputs any more.
void TaskQueue::Forget(const TaskPtr& task) {
  bool fewer = false;
  const auto forget = [&](const Hash& hash) {
    const auto it = waiting_.find(hash);
    if (it == waiting_.end()) return;
    std::erase(it->second, task);
    if (!it->second.empty()) return;
    waiting_.erase(it);
    fewer = true;
  };
  for (const Hash& hash : task->lacking) forget(hash);
  for (const Hash& hash : task->partials_asked) forget(hash);
  if (fewer) std::erase_if(wants_, [this](const Want& want) { return !waiting_.contains(want.hash); });
}

void TaskQueue::Cancel(const wire::TaskKey& key) {
  const Lock lock(mutex_);
  const auto is_it = [&key](const TaskPtr& task) { return SameAttempt(task->assign.key(), key); };
  for (const TaskPtr& task : queue_)
    if (is_it(task)) Forget(task);
  std::erase_if(queue_, is_it);
  if (running_ && is_it(running_)) {
    running_->cancelled = true;
    Forget(running_);
  }
  changed_.notify_all();
}

void TaskQueue::DropAll() {
  const Lock lock(mutex_);
  queue_.clear();
  waiting_.clear();
  wants_.clear();
  answers_.clear();
  if (running_) running_->cancelled = true;
  changed_.notify_all();
}

void TaskQueue::Deliver(const wire::NamedBlob& named) {
  const Lock lock(mutex_);
  const auto node = waiting_.extract(named.hash);
  if (node.empty()) return;
  for (const TaskPtr& task : node.mapped()) {
    if (task->lacking.erase(named.hash) > 0) task->blobs[named.hash] = named.blob;
    if (task->partials_asked.erase(named.hash) > 0) task->partial_blobs[named.hash] = named.blob;
    ++task->ticks;  // an input that comes is a sign of progress too
  }
  changed_.notify_all();
}

// Over a slow link an input takes as long as it takes: what waits for it does move.
void TaskQueue::NoteArrival() {
  const Lock lock(mutex_);
  for (const auto& [hash, tasks] : waiting_)
    for (const TaskPtr& task : tasks) ++task->ticks;
}

void TaskQueue::GiveUp(const Hash& hash, const std::string& why) {
  const Lock lock(mutex_);
  const auto node = waiting_.extract(hash);
  if (node.empty()) return;
  for (const TaskPtr& task : node.mapped())
    task->failure = !why.empty()
                        ? "the plan is wrong: " + why
                        : "the coordinator does not have blob " + hash.Hex() +
                              " any more, or cannot read it (its log says why): submit the job again";
  changed_.notify_all();
}

std::optional<Want> TaskQueue::TakeWant() {
  const Lock lock(mutex_);
  if (wants_.empty()) return std::nullopt;
  const Want want = wants_.front();
  wants_.pop_front();
  return want;
}

std::vector<wire::Message> TaskQueue::TakeAnswers() {
  const Lock lock(mutex_);
  return std::exchange(answers_, {});
}

wire::Heartbeat TaskQueue::Assigned() const {
  const Lock lock(mutex_);
  wire::Heartbeat heartbeat;
  const auto add = [&heartbeat](const AssignedTask& task) {
    *heartbeat.add_tasks() = task.assign.key();
    heartbeat.add_ticks(task.ticks);
  };
  if (running_ && !running_->cancelled) add(*running_);
  heartbeat.set_stuck(running_ && running_->cancelled);
  for (const TaskPtr& task : queue_) add(*task);
  return heartbeat;
}

bool TaskQueue::Empty() const {
  const Lock lock(mutex_);
  return queue_.empty() && answers_.empty() && (!running_ || running_->cancelled);
}

std::size_t TaskQueue::Count() const {
  const Lock lock(mutex_);
  return queue_.size() + answers_.size() + (running_ && !running_->cancelled ? 1 : 0);
}

void TaskQueue::Close() {
  const Lock lock(mutex_);
  closed_ = true;
  if (running_) running_->cancelled = true;
  changed_.notify_all();
}

TaskPtr TaskQueue::Next() {
  Lock lock(mutex_);
  const auto ready = [this] {
    return closed_ || (!queue_.empty() && (queue_[0]->lacking.empty() || !queue_[0]->failure.empty()));
  };
  changed_.wait(lock, ready);
  if (closed_) return nullptr;
  running_ = queue_.front();
  queue_.pop_front();
  return running_;
}

std::string TaskQueue::FailureOf(const AssignedTask& task) const {
  const Lock lock(mutex_);
  return task.failure;
}

BlobPtr TaskQueue::AwaitInput(AssignedTask& task, Want want) {
  Lock lock(mutex_);
  CAIRN_DEMAND(running_.get() == &task, "another task runs");
  if (task.cancelled) throw Cancelled{};
  const Hash hash = want.hash;
  if (!task.blobs.contains(hash)) {
    task.lacking.insert(hash);
    WantOne(running_, std::move(want));
    wake_();
  }
  changed_.wait(lock, [&] { return task.cancelled || !task.failure.empty() || task.blobs.contains(hash); });
  if (task.cancelled) throw Cancelled{};
  if (!task.failure.empty()) throw std::runtime_error(task.failure);
  return task.blobs.at(hash);
}

BlobPtr TaskQueue::AwaitPartial(AssignedTask& task, std::size_t index) {
  Lock lock(mutex_);
  CAIRN_DEMAND(running_.get() == &task && index < task.partials.size(), "no such partial");
  const Hash hash = task.partials[index];
  if (task.cancelled) throw Cancelled{};
  WantPartials(running_, index);
  if (!wants_.empty()) wake_();
  changed_.wait(lock,
                [&] { return task.cancelled || !task.failure.empty() || task.partial_blobs.contains(hash); });
  if (task.cancelled) throw Cancelled{};
  if (!task.failure.empty()) throw std::runtime_error(task.failure);
  ++task.ticks;
  BlobPtr blob = task.partial_blobs.at(hash);
  if (--task.partial_uses[hash] <= 0) task.partial_blobs.erase(hash);
  return blob;
}

void TaskQueue::Finish(const AssignedTask& task, wire::Message answer) {
  {
    const Lock lock(mutex_);
    CAIRN_DEMAND(running_.get() == &task, "another task runs");
    Forget(running_);  // what it did without, or did not come to
    running_.reset();
    if (task.cancelled) return;
    answers_.push_back(std::move(answer));
  }
  wake_();
}

}  // namespace cairn::worker
