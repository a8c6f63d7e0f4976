// BaLL, Bayesian landmark learning: [Thr98].
#pragma once

#include <array>
#include <cstdint>

#include "pipelines/landmark_learning/state/options.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

// Input (schema/FORMAT.md): samples. Result: kind networks. A round is a gradient step: tasks `gradient`,
// each a block of true positions against all samples in their reach, and every few steps tasks `validate` on
// the held-out run; Advance adds up and takes the step. Some methods have a second round a step (Phase in
// training.h).
class LandmarkLearning : public Pipeline {
 public:
  LandmarkLearning(Options options, std::uint64_t seed) : options_(std::move(options)), seed_(seed) {}

  Step Start(const Inputs& inputs) const override;
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override;
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override;

 private:
  Options options_;
  std::uint64_t seed_;
};

// For the registry.
using PipelineType = LandmarkLearning;
inline constexpr char kSummary[] = "networks that extract the features which localise best (BaLL)";
inline constexpr std::array kInputRoles = {"samples", "weights?", "map?", "errors?"};

}  // namespace cairn::landmark_learning
