#include "pipelines/landmark_learning/plan.h"

#include <initializer_list>

#include "pipelines/landmark_learning/batch.h"
#include "pipelines/landmark_learning/block_task.h"
#include "pipelines/landmark_learning/compact.h"
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

// The path that is planned, so that no task plans it again.
void SetSum(const SumPlan& sum, Task* task) { (*task->mutable_params())["sum"].set_s(sum.Name()); }

}  // namespace

// Blocks of all truths; one where a sweep over all samples is what a block would cost too.
std::vector<Range> Planner::TrainingBlocks(int networks) const {
  const int count = data_.training.size();
  if (IsOneSweep(options_, sum_)) return {{0, count}};
  return Blocks(count, StepFlops(networks));
}

std::size_t Planner::Weights(int networks) const {
  NetworkShape shape = ShapeOf(options_, data_.mean.size());
  shape.networks = networks;
  return shape.parameters();
}

// Of a step on all truths by so many networks.
double Planner::StepFlops(int networks) const {
  return flops_per_vector_ * VectorsOf(networks) +
         4.0 * data_.training.size() * static_cast<double>(Weights(networks));
}

// Blocks of the stretches of a mini-batch.
std::vector<Range> Planner::BatchBlocks(int stretches, int networks) const {
  const double share = static_cast<double>(stretches) * kStretch / data_.training.size();
  return Blocks(stretches, share * StepFlops(networks));
}

// Blocks of truths; of a mini-batch, of the stretches that are drawn.
void Planner::PlanGradient(const Training& t, proto::Step* plan) const {
  const char* kind = t.phase == Phase::kSlopes ? "slopes" : "gradient";
  const auto stretches = DrawnStretches(data_.training.size(), options_.batch, seed_, t.steps);
  const bool all = TruthsIn(stretches) == data_.training.size();
  const auto blocks =
      all ? TrainingBlocks(t.learning.end) : BatchBlocks(static_cast<int>(stretches.size()), t.learning.end);
  for (const Range& block : blocks) {
    Task& task = Add(kind, all ? block.size() : block.size() * kStretch, {"data", "parameters"}, plan);
    SetBlock(block, &task);
    SetLearning(t.learning, &task);
    SetSum(sum_, &task);
    Set("step", t.steps, &task);
  }
}

// Whether blocks of their own would compute most outputs again and again.
bool Planner::InPhases(int networks) const {
  if (options_.cell_m > 0.0) return true;  // cells are made of the outputs of all samples
  if (options_.batch > 0) return false;
  constexpr std::size_t kFew = 4;  // blocks that do so for less than three rounds cost
  const auto blocks = TrainingBlocks(networks);
  if (blocks.size() <= kFew) return false;
  const Places& places = sum_.PlacesOf(data_.training.places);
  const Pairs pairs(places, places, BeliefOf(options_), ErrorOf(options_));
  std::int64_t outputs = 0;
  for (const Range& block : blocks) outputs += pairs.ReachOf(block).size();
  return outputs > 2 * static_cast<std::int64_t>(data_.training.size());
}

Phase Planner::FirstPhase(int networks) const {
  if (InPhases(networks)) return Phase::kOutputs;
  return options_.method == "pseudo" ? Phase::kSlopes : Phase::kGradient;
}

// Rounds of a step in phases: outputs and weights by samples, pairs by truths.
void Planner::PlanPhase(const Training& t, proto::Step* plan) const {
  const int count = data_.training.size();
  const double forward = 2.0 * count * static_cast<double>(Weights(t.learning.end));
  const auto add = [&](const char* kind, const std::vector<Range>& blocks,
                       std::initializer_list<const char*> blobs) {
    for (const Range& block : blocks) {
      Task& task = Add(kind, block.size(), blobs, plan);
      SetBlock(block, &task);
      SetLearning(t.learning, &task);
      SetSum(sum_, &task);
      Set("step", t.steps, &task);
    }
  };
  if (t.phase == Phase::kOutputs) add("outputs", Blocks(count, forward), {"data", "parameters"});
  // Each has P(f | s) and slopes of all samples to make: fewer of them, and larger ones.
  if (t.phase == Phase::kPairs) {
    int truths = count;
    double flops_per_vector = flops_per_vector_;
    if (options_.cell_m > 0.0) {
      const Cells cells = CellsOf(data_.training, options_.cell_m);
      truths = cells.size();
      flops_per_vector = FlopsPerVector(options_, SumPath::kPairs, cells.places);
    }
    add("pairs", Blocks(truths, flops_per_vector * VectorsOf(t.learning.end) / 8.0), {"data", "outputs"});
  }
  if (t.phase == Phase::kWeights)
    add("weights", Blocks(count, 2.0 * forward), {"data", "parameters", "slopes"});
}

void Planner::PlanSearch(proto::Step* plan) const {
  for (std::size_t length = 0; length < Conjugate::kTried.size(); ++length) {
    for (const Range& block : TrainingBlocks(static_cast<int>(options_.networks))) {
      Task& task = Add("search", block.size(), {"data", "parameters", "training"}, plan);
      SetBlock(block, &task);
      Set("length", static_cast<std::int64_t>(length), &task);
    }
  }
}

void Planner::PlanFit(proto::Step* plan) const {
  for (std::int64_t network = 0; network < options_.networks; ++network) {
    Task& task =
        Add("fit", options_.pattern_steps * data_.training.size(), {"data", "parameters", "slopes"}, plan);
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
    const bool phases = training.phase == Phase::kOutputs || training.phase == Phase::kPairs ||
                        training.phase == Phase::kWeights;
    if (phases)
      PlanPhase(training, &plan);
    else
      PlanGradient(training, &plan);
    if (FindsSlopes(training.phase) && Validates(training.steps)) {
      const double pairs = static_cast<double>(data_.held_out.size()) * data_.training.size();
      for (const Range& block :
           Blocks(data_.held_out.size(), 8.0 * pairs * VectorsOf(training.learning.end))) {
        Task& task = Add("validate", block.size(), {"data", "parameters"}, &plan);
        SetBlock(block, &task);
        SetLearning(training.learning, &task);
      }
    }
  }
  const bool two = options_.method == "pseudo" || options_.method == "conjugate";
  const std::int64_t rounds =
      (two ? 2 : 1) + (InPhases(training.learning.end) ? options_.method == "pseudo" ? 1 : 2 : 0);
  plan.set_rounds_left(static_cast<std::uint32_t>(
      std::min<std::int64_t>(rounds * (options_.steps - training.steps), 1'000'000'000)));
}

bool Planner::FindsSlopes(Phase phase) const {
  if (phase == Phase::kPairs) return options_.method == "pseudo";
  return phase == Phase::kGradient || phase == Phase::kSlopes || phase == Phase::kWeights;
}

bool Planner::Validates(std::int64_t steps_done) const {
  return data_.held_out.size() > 0 && steps_done % options_.validate_every == 0;
}

}  // namespace cairn::landmark_learning
