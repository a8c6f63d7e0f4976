// How large the local grids are and how dense their beams: as the options say, else by what the scans see.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/common/range_scans.h"
#include "pipelines/common/task_builder.h"
#include "pipelines/local_map/options.h"
#include "pipelines/local_map/path/runs.h"
#include "schema/job.pb.h"
#include "schema/kinds/fields.h"

namespace cairn::local_map {

struct Size {
  double cell_m = 0.15;
  std::int64_t half_cells = 15;
  std::int64_t ring_beams = 72;
  static void Fields(const auto& field) {
    field("cell_m", &Size::cell_m);
    field("half_cells", &Size::half_cells);
    field("ring_beams", &Size::ring_beams);
  }
  double reach_m() const { return static_cast<double>(half_cells) * cell_m; }
  // Cells, cells to a side and cells to a metre, as a multiple of those of Size{}.
  double cells() const { return columns() * columns(); }
  double columns() const { return static_cast<double>(2 * half_cells + 1) / 31; }
  double finer() const { return 0.15 / cell_m; }
};

// What the options do not give: that of Size{} for what sees walls within its reach. Where a robot's lasers
// drive through a hall, that is, on more than 15% of its way, in stretches of more than 5 m, less than 5% of
// a scan's beams end within that reach: that of kHall, and no more cells than three quarters of the readings
// of nine tenths of the way reach. Throws InputError where an option is neither 0 nor within its range.
Size ChooseSize(const Options& options, const PosedScans& scans, const std::vector<RobotRuns>& robots);
inline constexpr Size kHall{.cell_m = 0.3, .half_cells = 60, .ring_beams = 180};

// As the plan's state has it, for a task; as a task has it.
// SizeOf throws InputError where it is out of range.
void SetSize(const proto::State& state, TaskBuilder* task);
Size SizeOf(const proto::Task& task);

// The options with that size.
Options Sized(Options options, const Size& size);

}  // namespace cairn::local_map
