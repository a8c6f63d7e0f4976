#include "pipelines/landmark_learning/plan.h"

#include <initializer_list>

#include "pipelines/landmark_learning/batch.h"
#include "pipelines/landmark_learning/block_task.h"
#include "pipelines/landmark_learning/features.h"

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

double VectorsOf(int networks) { return static_cast<double>(FeatureVectors(networks)); }

void SetLearning(const Learning& learning, Task* task) {
  Set("learns", learning.first, task);
  Set("in_use", learning.end, task);
}

}  // namespace

// Blocks of all truths; one where a sweep over all samples is what a block would cost too.
std::vector<Range> Planner::TrainingBlocks(int networks) const {
  const int count = data_.training.size();
  const SumPlan sum = PlanSum(options_, data_.training.places);
  if (sum.path == SumPath::kLine && options_.window_m == 0.0) return {{0, count}};
  return Blocks(count, StepFlops(sum, networks));
}

// Of a step on all truths by so many networks.
double Planner::StepFlops(const SumPlan& sum, int networks) const {
  const NetworkShape shape{networks, static_cast<int>(data_.mean.size()), static_cast<int>(options_.hidden)};
  return sum.flops_per_vector * VectorsOf(networks) +
         4.0 * data_.training.size() * static_cast<double>(shape.parameters());
}

// Blocks of the stretches of a mini-batch.
std::vector<Range> Planner::BatchBlocks(int stretches, int networks) const {
  const double share = static_cast<double>(stretches) * kStretch / data_.training.size();
  return Blocks(stretches, share * StepFlops(PlanSum(options_, data_.training.places), networks));
}

// Blocks of truths; of a mini-batch, of the stretches that are drawn.
void Planner::PlanGradient(const Training& t, proto::Step* plan) const {
  const char* kind = t.phase == Phase::kSlopes ? "slopes" : "gradient";
  const auto stretches = DrawnStretches(data_.training.size(), options_.batch, seed_, t.steps);
  const bool all = stretches.size() == 1;
  const auto blocks =
      all ? TrainingBlocks(t.learning.end) : BatchBlocks(static_cast<int>(stretches.size()), t.learning.end);
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
      const double pairs = static_cast<double>(data_.held_out.size()) * data_.training.size();
      for (const Range& block :
           Blocks(data_.held_out.size(), 8.0 * pairs * VectorsOf(training.learning.end))) {
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
