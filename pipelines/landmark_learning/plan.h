// The tasks of a round: a gradient step, and every few steps a look at the held-out run.
#pragma once

#include "pipelines/landmark_learning/training.h"
#include "pipelines/landmark_learning/training_data.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

class Planner {
 public:
  Planner(const Options& options, const TrainingData& data) : options_(options), data_(data) {}

  // The tasks of the next step, on the weights that `step` has in its State.
  void Plan(const Training& training, Step* step) const;
  bool Validates(std::int64_t steps_done) const;

 private:
  const Options& options_;
  const TrainingData& data_;
};

}  // namespace cairn::landmark_learning
