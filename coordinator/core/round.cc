#include "coordinator/core/round.h"

#include <algorithm>

#include "schema/blob_part.h"

namespace cairn::coordinator {
namespace {

// Who comes and goes for ever must not keep a job from its end.
constexpr int kMostExcuses = 20;  // of a task

}  // namespace

Round Round::OfTasks(const proto::Step& step) {
  Round round;
  round.kind_ = wire::TaskKey::RUN;
  round.tasks_.resize(step.tasks_size());
  for (const proto::Task& task : step.tasks()) {
    std::set<std::uint32_t> earlier;
    TaskRecord& record = round.tasks_[task.index()];
    for (const proto::InputRef& input : task.inputs()) {
      if (input.has_task()) earlier.insert(input.task());
      if (input.has_part())
        record.parts.push_back(NameOfPart(Hash::FromBinary(input.blob()).value(), input.part()));
    }
    record.cost = std::max<std::uint64_t>(task.cost(), 1);
    round.CountAsWaiting(record);
    record.waits_for = static_cast<std::uint32_t>(earlier.size());
    for (const std::uint32_t index : earlier) round.tasks_[index].followers.push_back(task.index());
    if (earlier.empty()) round.Move(record, task.index(), TaskStatus::kReady);
  }
  for (auto task = round.tasks_.rbegin(); task != round.tasks_.rend(); ++task) {  // followers come later
    for (const std::uint32_t follower : task->followers)
      task->chain = std::max(task->chain, round.tasks_[follower].chain);
    task->chain += static_cast<double>(task->cost);
    round.cost_ += static_cast<double>(task->cost);
    round.chain_ = std::max(round.chain_, task->chain);
  }
  return round;
}

Round Round::OfPlan(wire::TaskKey::Kind kind) {
  Round round;
  round.kind_ = kind;
  round.tasks_.resize(1);
  round.CountAsWaiting(round.tasks_[0]);
  round.Move(round.tasks_[0], 0, TaskStatus::kReady);
  return round;
}

std::uint32_t Round::NextReady() const {
  CAIRN_DEMAND(HasReady(), "no task is ready");
  return ready_.begin()->second;
}

std::vector<std::uint32_t> Round::FirstReady(std::size_t most) const {
  std::vector<std::uint32_t> first;
  for (auto it = ready_.begin(); it != ready_.end() && first.size() < most; ++it) first.push_back(it->second);
  return first;
}

std::uint32_t Round::Begin(std::uint32_t index, std::uint64_t worker) {
  TaskRecord& task = tasks_.at(index);
  CAIRN_DEMAND(task.status == TaskStatus::kReady || task.status == TaskStatus::kRunning, "task cannot begin");
  task.live_attempts.push_back({++task.attempts, worker});
  Move(task, index, TaskStatus::kRunning);
  return task.attempts;
}

bool Round::Withdraw(std::uint32_t index, std::uint32_t attempt) {
  TaskRecord& task = tasks_.at(index);
  const auto erased =
      std::erase_if(task.live_attempts, [attempt](const Attempt& live) { return live.number == attempt; });
  if (erased == 0) return false;
  if (task.live_attempts.empty()) Move(task, index, TaskStatus::kReady);
  return true;
}

int Round::Blame(std::uint32_t index, std::uint64_t worker) {
  TaskRecord& task = tasks_.at(index);
  task.failed_at.push_back(worker);
  return ++task.failures;
}

bool Round::Excuse(std::uint32_t index) {
  TaskRecord& task = tasks_.at(index);
  if (task.excuses >= kMostExcuses) return false;
  ++task.excuses;
  return true;
}

bool Round::TakeBack(std::uint32_t index) {
  TaskRecord& task = tasks_.at(index);
  if (task.status == TaskStatus::kDone || task.failures == 0 || !Excuse(index)) return false;
  --task.failures;
  return true;
}

void Round::Finish(std::uint32_t index, const Hash& partial) {
  TaskRecord& task = tasks_.at(index);
  CAIRN_DEMAND(task.status != TaskStatus::kDone, "a task ends once");
  task.partial = partial;
  task.live_attempts.clear();
  Move(task, index, TaskStatus::kDone);
  for (const std::uint32_t follower : task.followers) {
    TaskRecord& next = tasks_[follower];
    // A follower may be done already: its answer from before a restart of the coordinator counts.
    if (--next.waits_for == 0 && next.status == TaskStatus::kWaiting)
      Move(next, follower, TaskStatus::kReady);
  }
}

void Round::CountAsWaiting(const TaskRecord& task) {
  Share& waiting = shares_.at(static_cast<std::size_t>(TaskStatus::kWaiting));
  ++waiting.tasks;
  waiting.cost += static_cast<double>(task.cost);
}

void Round::Move(TaskRecord& task, std::uint32_t index, TaskStatus status) {
  Share& before = shares_.at(static_cast<std::size_t>(task.status));
  Share& now = shares_.at(static_cast<std::size_t>(status));
  --before.tasks;
  ++now.tasks;
  before.cost -= static_cast<double>(task.cost);
  now.cost += static_cast<double>(task.cost);
  if (task.status == TaskStatus::kReady) ready_.erase({~task.cost, index});
  task.status = status;
  if (status == TaskStatus::kReady) ready_.insert({~task.cost, index});
}

}  // namespace cairn::coordinator
