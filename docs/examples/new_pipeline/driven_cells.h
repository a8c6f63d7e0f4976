// Where the robot drove nothing stands: an example of a pipeline (CONTRIBUTING.md, "A new pipeline").
#pragma once

#include <array>
#include <cstdint>

#include "pipelines/common/range_scans.h"
#include "pipelines/pipeline.h"

namespace cairn::driven_cells {

struct Options {
  GridOptions grid;  // of all pipelines that make grid maps: cell_m, box_m, …
  double p_occupied = 0.05;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  VisitGridOptions(visit, o.grid);
  visit(Option{"p_occupied", "", 0, 0.5, "p(m_xy) of a cell in which the robot was"}, o.p_occupied);
}

// Input (schema/FORMAT.md): a log with range scans and poses. Result: a grid_map. One round: a task is a
// sensor, whose scans say where the robot was.
class DrivenCells : public Pipeline {
 public:
  DrivenCells(Options options, std::uint64_t /*seed*/) : options_(std::move(options)) {}

  Step Start(const Inputs& inputs) const override;
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override;
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override;

 private:
  Options options_;
};

// For the registry.
using PipelineType = DrivenCells;
inline constexpr char kSummary[] =
    "an example: cells in which the robot was are free, nothing is known of others";
inline constexpr std::array kInputRoles = {"log"};

}  // namespace cairn::driven_cells
