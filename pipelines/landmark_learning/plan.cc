#include "pipelines/landmark_learning/plan.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "pipelines/common/task_builder.h"
#include "pipelines/landmark_learning/error_sum/features.h"
#include "pipelines/landmark_learning/optimizer/batch.h"
#include "pipelines/landmark_learning/tasks/block_task.h"
#include "pipelines/landmark_learning/tasks/compact.h"

namespace cairn::landmark_learning {
namespace {

// Of a core, the pairs' among them; as Blocks counts them.
constexpr double kFlopsPerUs = 4e4;

// A task of so many flops, with the blobs of the State that it reads.
TaskBuilder Add(const char* kind, double flops, std::initializer_list<const char*> blobs, proto::Step* plan) {
  TaskBuilder task(kind, flops / kFlopsPerUs, plan);
  for (const char* name : blobs) task.Read(name);
  return task;
}

void SetBlock(const IndexRange& block, TaskBuilder* task) {
  task->Set("first", block.first).Set("end", block.end);
}

double VectorsOf(int networks) { return static_cast<double>(FeatureVectors(networks)); }

void SetLearning(const Learning& learning, TaskBuilder* task) {
  task->Set("learns", learning.first).Set("in_use", learning.end);
}

}  // namespace

// Blocks of all true positions; one where a sweep over all samples is what a block would cost too.
std::vector<IndexRange> Planner::TrainingBlocks(int networks) const {
  const int count = data_.training.size();
  if (IsOneSweep(options_, sum_)) return {{0, count}};
  return Blocks(count, StepFlops(networks));
}

std::size_t Planner::Weights(int networks) const {
  NetworkShape shape = ShapeOf(options_, data_.mean.size());
  shape.networks = networks;
  return shape.parameters();
}

// Of a step on all true positions by so many networks.
double Planner::StepFlops(int networks) const {
  return flops_per_vector_ * VectorsOf(networks) +
         4.0 * data_.training.size() * static_cast<double>(Weights(networks));
}

// Blocks of the stretches of a mini-batch.
std::vector<IndexRange> Planner::BatchBlocks(int stretches, int networks) const {
  const double share = static_cast<double>(stretches) * kStretch / data_.training.size();
  return Blocks(stretches, share * StepFlops(networks));
}

// Blocks of true positions; of a mini-batch, of the stretches that are drawn.
void Planner::PlanGradient(const Training& t, proto::Step* plan) const {
  const char* kind = t.phase == Phase::kOutputGradient ? "output_gradient" : "gradient";
  const auto stretches = DrawnStretches(data_.training.size(), options_.batch, seed_, t.steps);
  const bool all = TruePositionsIn(stretches) == data_.training.size();
  const auto blocks =
      all ? TrainingBlocks(t.learning.end) : BatchBlocks(static_cast<int>(stretches.size()), t.learning.end);
  const double of_truth = StepFlops(t.learning.end) / data_.training.size();
  for (const IndexRange& block : blocks) {
    const double true_positions = all ? block.size() : block.size() * kStretch;
    TaskBuilder task = Add(kind, of_truth * true_positions, {"data", "parameters"}, plan);
    SetBlock(block, &task);
    SetLearning(t.learning, &task);
    task.Set("step", t.steps);
  }
}

// Whether blocks of their own would compute most outputs again and again.
bool Planner::InPhases(int networks) const {
  if (options_.cell_m > 0.0) return true;  // cells are made of the outputs of all samples
  if (options_.batch > 0) return false;
  constexpr std::size_t kFew = 4;  // blocks that do so for less than three rounds cost
  const auto blocks = TrainingBlocks(networks);
  if (blocks.size() <= kFew) return false;
  const Positions& positions = sum_.PositionsOf(data_.training.positions);
  const Pairs pairs(positions, positions, BeliefOf(options_), ErrorOf(options_));
  std::int64_t outputs = 0;
  for (const IndexRange& block : blocks) outputs += pairs.ReachOf(block).size();
  return outputs > 2 * static_cast<std::int64_t>(data_.training.size());
}

Phase Planner::FirstPhase(int networks) const {
  if (InPhases(networks)) return Phase::kOutputs;
  return options_.method == "pseudo" ? Phase::kOutputGradient : Phase::kGradient;
}

// Rounds of a step in phases: outputs and weights by samples, pairs by true positions.
void Planner::PlanPhase(const Training& t, proto::Step* plan) const {
  const int count = data_.training.size();
  const double forward = 2.0 * count * static_cast<double>(Weights(t.learning.end));
  const auto add = [&](const char* kind, const std::vector<IndexRange>& blocks, double flops,
                       std::initializer_list<const char*> blobs) {
    for (const IndexRange& block : blocks) {
      TaskBuilder task = Add(kind, flops / static_cast<double>(blocks.size()), blobs, plan);
      SetBlock(block, &task);
      SetLearning(t.learning, &task);
      task.Set("step", t.steps);
    }
  };
  if (t.phase == Phase::kOutputs) add("outputs", Blocks(count, forward), forward, {"data", "parameters"});
  // Each has P(f | s) and gradients of all samples to make: fewer of them, and larger ones.
  if (t.phase == Phase::kPairs) {
    int true_positions = count;
    double flops_per_vector = flops_per_vector_;
    if (options_.cell_m > 0.0) {
      const Cells cells = CellsOf(data_.training, options_.cell_m);
      true_positions = cells.size();
      flops_per_vector = FlopsPerVector(options_, SumPath::kPairs, cells.positions);
    }
    const double flops = flops_per_vector * VectorsOf(t.learning.end);
    add("pairs", Blocks(true_positions, flops / 8.0), flops, {"data", "outputs"});
  }
  if (t.phase == Phase::kWeights)
    add("weights", Blocks(count, 2.0 * forward), 2.0 * forward, {"data", "parameters", "gradient"});
}

void Planner::PlanSearch(proto::Step* plan) const {
  for (std::size_t length = 0; length < Conjugate::kTried.size(); ++length) {
    for (const IndexRange& block : TrainingBlocks(static_cast<int>(options_.networks))) {
      const double flops = SearchFlops() * block.size() / data_.training.size();
      TaskBuilder task = Add("search", flops, {"data", "parameters", "training"}, plan);
      SetBlock(block, &task);
      task.Set("length", static_cast<std::int64_t>(length));
    }
  }
}

void Planner::PlanFit(proto::Step* plan) const {
  for (std::int64_t network = 0; network < options_.networks; ++network) {
    TaskBuilder task = Add("fit", FitFlops() / static_cast<double>(options_.networks),
                           {"data", "parameters", "gradient"}, plan);
    task.Set("network", network);
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
    if (FindsGradient(training.phase) && Validates(training.steps)) {
      const double flops = ValidateFlops(training.learning.end);
      for (const IndexRange& block : Blocks(data_.held_out.size(), flops)) {
        TaskBuilder task =
            Add("validate", flops * block.size() / data_.held_out.size(), {"data", "parameters"}, &plan);
        SetBlock(block, &task);
        SetLearning(training.learning, &task);
      }
    }
  }
  ExpectSteps(training, &plan);
}

// Of a step along a line: E alone, of each length that is tried.
double Planner::SearchFlops() const { return StepFlops(static_cast<int>(options_.networks)) / 3.0; }

double Planner::FitFlops() const {
  return 6.0 * static_cast<double>(options_.pattern_steps) * data_.training.size() *
         static_cast<double>(Weights(static_cast<int>(options_.networks)));
}

double Planner::ValidateFlops(int networks) const {
  return 8.0 * data_.held_out.size() * data_.training.size() * VectorsOf(networks);
}

// All that a step of so many networks takes.
double Planner::FlopsOfAStep(int networks) const {
  const double batch = options_.batch > 0 ? static_cast<double>(options_.batch) : HUGE_VAL;
  double flops = StepFlops(networks) * std::min(1.0, batch / data_.training.size());
  if (options_.method == "pseudo") flops += FitFlops();
  if (options_.method == "conjugate") flops += static_cast<double>(Conjugate::kTried.size()) * SearchFlops();
  return flops + ValidateFlops(networks) / static_cast<double>(options_.validate_every);
}

// The rounds that are left of this step, and those of all that follow it; training may end earlier.
void Planner::ExpectSteps(const Training& training, proto::Step* plan) const {
  const bool pseudo = options_.method == "pseudo", two = pseudo || options_.method == "conjugate";
  const int networks = training.learning.end;
  const int rounds = (two ? 2 : 1) + (InPhases(networks) ? (pseudo ? 1 : 2) : 0);
  double cost = 0.0;
  for (const Task& task : plan->tasks()) cost += static_cast<double>(task.cost());
  const auto left = static_cast<double>(options_.steps - training.steps - 1);
  double flops = left * FlopsOfAStep(networks);
  if (options_.sequential) {  // each of those that join gets its share of the steps
    const double share = static_cast<double>(options_.steps) / static_cast<double>(options_.networks);
    flops = std::max(0.0, share - static_cast<double>(training.network_steps) - 1.0) * FlopsOfAStep(networks);
    for (int n = networks + 1; n <= options_.networks; ++n) flops += share * FlopsOfAStep(n);
  }
  const double width = static_cast<double>(plan->tasks_size());
  const int behind = RoundOfStep(training.phase);
  if (behind + 1 < rounds) {
    ExpectRounds(rounds - behind - 1, std::max(0.0, FlopsOfAStep(networks) / kFlopsPerUs - cost), width,
                 plan);
  }
  ExpectRounds(rounds * left, flops / kFlopsPerUs, width, plan);
}

// Rounds of its step that come before one of this phase.
int Planner::RoundOfStep(Phase phase) const {
  const bool phases = InPhases(static_cast<int>(options_.networks));
  switch (phase) {
    case Phase::kPairs:
      return 1;
    case Phase::kWeights:
      return 2;
    case Phase::kSearch:
      return phases ? 3 : 1;
    case Phase::kFit:
      return phases ? 2 : 1;
    case Phase::kGradient:
    case Phase::kOutputGradient:
    case Phase::kOutputs:
      break;
  }
  return 0;
}

bool Planner::FindsGradient(Phase phase) const {
  if (phase == Phase::kPairs) return options_.method == "pseudo";
  return phase == Phase::kGradient || phase == Phase::kOutputGradient || phase == Phase::kWeights;
}

bool Planner::Validates(std::int64_t steps_done) const {
  return data_.held_out.size() > 0 && steps_done % options_.validate_every == 0;
}

}  // namespace cairn::landmark_learning
