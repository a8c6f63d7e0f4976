// The tasks of a round, whatever its phase, and every few steps a look at the held-out run beside them.
#pragma once

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/state/state.h"
#include "pipelines/landmark_learning/state/sum_path.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

class Planner {
 public:
  Planner(const Options& options, std::uint64_t seed, const TrainingData& data, SumPlan sum)
      : options_(options),
        seed_(seed),
        data_(data),
        sum_(std::move(sum)),
        flops_per_vector_(FlopsPerVector(options, sum_.path, data.training.positions)) {}

  // The tasks of the next round, on what `step` has in its State.
  void Plan(const Training& training, Step* step) const;
  // Of a step of so many networks.
  Phase FirstPhase(int networks) const;
  // Whether a round of this phase ends with E and its gradients.
  bool FindsGradient(Phase phase) const;
  // Whether the step after so many looks at the held-out run.
  bool Validates(std::int64_t steps_done) const;

 private:
  void PlanGradient(const Training& training, proto::Step* plan) const;
  void PlanPhase(const Training& training, proto::Step* plan) const;
  void PlanSearch(proto::Step* plan) const;
  void PlanFit(proto::Step* plan) const;
  bool InPhases(int networks) const;
  std::vector<IndexRange> TrainingBlocks(int networks) const;
  std::vector<IndexRange> BatchBlocks(int stretches, int networks) const;
  void ExpectSteps(const Training& training, proto::Step* plan) const;
  int RoundOfStep(Phase phase) const;
  double StepFlops(int networks) const;
  double SearchFlops() const;
  double FitFlops() const;
  double ValidateFlops(int networks) const;
  double FlopsOfAStep(int networks) const;
  std::size_t Weights(int networks) const;

  const Options& options_;
  std::uint64_t seed_;
  const TrainingData& data_;
  SumPlan sum_;
  double flops_per_vector_;
};

}  // namespace cairn::landmark_learning
