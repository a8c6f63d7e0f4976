// Occupancy by log-odds and inverse sensor models, a cell by itself: [Thr01] eq. 1, after H. P. Moravec and
// A. Elfes. The baseline of forward_map.
#pragma once

#include <array>
#include <cstdint>

#include "pipelines/evidence_map/options.h"
#include "pipelines/pipeline.h"

namespace cairn::evidence_map {

// Inputs (schema/FORMAT.md): a log with range scans; it may be `poses`. Result: a grid_map with log-odds. Two
// rounds: a task is a time slice of one sensor's scans, whose ranges the first looks at and the second counts
// (parts.h).
class EvidenceMap : public Pipeline {
 public:
  EvidenceMap(Options options, std::uint64_t /*seed*/) : options_(std::move(options)) {}

  Step Start(const Inputs& inputs) const override;
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override;
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override;

 private:
  Options options_;
};

// For the registry.
using PipelineType = EvidenceMap;
inline constexpr char kSummary[] = "occupancy of each cell by itself: log-odds and inverse sensor models";
inline constexpr std::array kInputRoles = {"log", "poses?"};

}  // namespace cairn::evidence_map
