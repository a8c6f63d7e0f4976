// Local grids, edge traces and their graph: [DM98].
#pragma once

#include <array>
#include <cstdint>

#include "pipelines/local_map/options.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

// Input (schema/FORMAT.md): a log with range readings. Result: a local_map.
class LocalMap : public Pipeline {
 public:
  LocalMap(Options options, std::uint64_t /*seed*/) : options_(std::move(options)) {}

  Step Start(const Inputs& inputs) const override;
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override;
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override;

 private:
  Options options_;
};

// For the registry.
using PipelineType = LocalMap;
inline constexpr char kSummary[] = "local grids, edge traces, and a path put together from their graph";
inline constexpr std::array kInputRoles = {"log"};

}  // namespace cairn::local_map
