#include "pipelines/landmark_learning/plan.h"

#include <initializer_list>

#include "pipelines/landmark_learning/batch.h"
#include "pipelines/landmark_learning/block_task.h"

namespace cairn::landmark_learning {
namespace {

// A task with the blobs of the State that it reads.
Task& Add(const char* kind, std::int64_t cost, std::initializer_list<const char*> blobs, proto::Step* plan) {
  Task& task = *plan->add_tasks();
  task.set_index(static_cast<std::uint32_t>(plan->tasks_size() - 1));
  task.set_kind(kind);
  task.set_cost(static_cast<std::uint64_t>(cost));
  for (const char* name : blobs) {
    proto::InputRef& input = *task.add_inputs();
    input.set_name(name);
    input.set_blob(plan->state().blobs().at(name));
  }
  return task;
}

void Set(const char* name, std::int64_t value, Task* task) { (*task->mutable_params())[name].set_i(value); }

void SetBlock(const Range& block, Task* task) {
  Set("first", block.first, task);
  Set("end", block.end, task);
}

void SetLearning(const Learning& learning, Task* task) {
  Set("learns", learning.first, task);
  Set("in_use", learning.end, task);
}

}  // namespace

std::vector<Range> Planner::TrainingBlocks(int networks) const {
  return Blocks(data_.training.size(), data_.training.size(), networks);
}

// Blocks of truths; of a mini-batch, of the stretches that are drawn.
void Planner::PlanGradient(const Training& t, proto::Step* plan) const {
  const char* kind = t.phase == Phase::kSlopes ? "slopes" : "gradient";
  const auto stretches = DrawnStretches(data_.training.size(), options_.batch, seed_, t.steps);
  const bool all = stretches.size() == 1;
  const auto blocks =
      all ? TrainingBlocks(t.learning.end)
          : Blocks(static_cast<int>(stretches.size()), kStretch * data_.training.size(), t.learning.end);
  for (const Range& block : blocks) {
    Task& task = Add(kind, all ? block.size() : block.size() * kStretch, {"data", "weights"}, plan);
    SetBlock(block, &task);
    SetLearning(t.learning, &task);
    if (!all) Set("step", t.steps, &task);
  }
}

void Planner::PlanSearch(proto::Step* plan) const {
  for (std::size_t length = 0; length < Conjugate::kTried.size(); ++length) {
    for (const Range& block : TrainingBlocks(static_cast<int>(options_.networks))) {
      Task& task = Add("search", block.size(), {"data", "weights", "training"}, plan);
      SetBlock(block, &task);
      Set("length", static_cast<std::int64_t>(length), &task);
    }
  }
}

void Planner::PlanFit(proto::Step* plan) const {
  for (std::int64_t network = 0; network < options_.networks; ++network) {
    Task& task =
        Add("fit", options_.pattern_steps * data_.training.size(), {"data", "weights", "slopes"}, plan);
    Set("network", network, &task);
  }
}

void Planner::Plan(const Training& training, Step* step) const {
  proto::Step& plan = step->plan;
  if (training.phase == Phase::kSearch) {
    PlanSearch(&plan);
  } else if (training.phase == Phase::kFit) {
    PlanFit(&plan);
  } else {
    PlanGradient(training, &plan);
    if (Validates(training.steps)) {
      for (const Range& block : Blocks(data_.held_out.size(), data_.training.size(), training.learning.end)) {
        Task& task = Add("validate", block.size(), {"data", "weights"}, &plan);
        SetBlock(block, &task);
        SetLearning(training.learning, &task);
      }
    }
  }
  const std::int64_t rounds = options_.method == "pseudo" || options_.method == "conjugate" ? 2 : 1;
  plan.set_rounds_left(static_cast<std::uint32_t>(
      std::min<std::int64_t>(rounds * (options_.steps - training.steps), 1'000'000'000)));
}

bool Planner::Validates(std::int64_t steps_done) const {
  return data_.held_out.size() > 0 && steps_done % options_.validate_every == 0;
}

}  // namespace cairn::landmark_learning
