// Markov localisation with learned or hand-made features: [Thr98] sections 2, 5.1.6 and 5.2.4.
#pragma once

#include <array>
#include <cstdint>

#include "pipelines/localization/options.h"
#include "pipelines/pipeline.h"

namespace cairn::localization {

// Inputs (schema/FORMAT.md): samples, and networks where features are learned. Result: kind localization. Two
// rounds: tasks `map`, each P(f | xi) of a block of positions; tasks `localize`, each some traverses.
class Localization : public Pipeline {
 public:
  Localization(Options options, std::uint64_t seed) : options_(std::move(options)), seed_(seed) {}

  Step Start(const Inputs& inputs) const override;
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override;
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override;

 private:
  Options options_;
  std::uint64_t seed_;
};

// For the registry.
using PipelineType = Localization;
inline constexpr char kSummary[] = "where robots are, by learned or hand-made features";
inline constexpr std::array kInputRoles = {"samples", "networks?", "networks_2?", "networks_3?"};

}  // namespace cairn::localization
