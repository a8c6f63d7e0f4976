// Occupancy maps by forward models: [Thr01].
#pragma once

#include <array>
#include <cstdint>

#include "pipelines/forward_map/options.h"
#include "pipelines/pipeline.h"

namespace cairn::forward_map {

// Inputs (schema/FORMAT.md): a log with range scans; it may be `poses`. Result: a grid_map. plan.h says what
// the rounds are.
class ForwardMap : public Pipeline {
 public:
  ForwardMap(Options options, std::uint64_t /*seed*/) : options_(std::move(options)) {}

  Step Start(const Inputs& inputs) const override;
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override;
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override;

 private:
  Options options_;
};

// For the registry.
using PipelineType = ForwardMap;
inline constexpr char kSummary[] = "occupancy maps by EM over forward sensor models, with uncertainty";
inline constexpr std::array kInputRoles = {"log", "poses?"};

}  // namespace cairn::forward_map
