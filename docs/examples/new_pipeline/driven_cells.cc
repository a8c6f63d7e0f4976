#include "pipelines/driven_cells/driven_cells.h"

#include <limits>
#include <set>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/task_builder.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::driven_cells {
namespace {

constexpr double kBytesPerCell = 8;
// Microseconds of a core: a pose; a cell of the result.
constexpr double kPoseUs = 0.1, kCellUs = 0.01;

}  // namespace

Step DrivenCells::Start(const Inputs& inputs) const {
  const BlobPtr log = inputs.Get("log");
  const PosedScans scans = ReadRangeScans(*log, nullptr, options_.grid);
  const GridBox grid = GridOf(scans, options_.grid, kBytesPerCell);
  Step step;
  Blob box, poses;
  PutFields("", grid, &box);
  PutScanPoses(scans, *log, &poses);
  auto& blobs = *step.plan.mutable_state()->mutable_blobs();
  blobs["grid"] = step.Share(std::move(box));
  blobs["scan poses"] = step.Share(std::move(poses));
  for (const RangeScans& sensor : scans.sensors)
    TaskBuilder("drive", kPoseUs * static_cast<double>(sensor.scans()), &step.plan)
        .Set("sensor", sensor.name)
        .Read("grid")
        .Read("scan poses");
  step.plan.set_advance_cost(kCellUs * static_cast<double>(grid.cells()));
  return step;
}

namespace {

// Another worker made it.
GridBox GridIn(const Options& options, const Inputs& inputs) {
  const auto grid = cairn::Read<GridBox>(*inputs.Get("grid"));
  RequireGrid(grid, MostCells(options.grid, kBytesPerCell));
  return grid;
}

}  // namespace

Blob DrivenCells::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  RequireKind(task, {"drive"});
  const GridBox grid = GridIn(options_, inputs);
  const Blob poses = inputs.Get("scan poses")->Sub(task.params().at("sensor").s());
  const auto x = poses.Get<double>("x_m"), y = poses.Get<double>("y_m");
  std::set<std::int64_t> driven;  // in order, whatever the order of the poses
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::int64_t column = grid.ColumnOf(x[k]), row = grid.RowOf(y[k]);
    if (grid.Holds(column, row)) driven.insert(row * grid.columns + column);
    progress.Tick();
  }
  Blob partial;
  partial.PutVector("cell", std::vector<std::int64_t>(driven.begin(), driven.end()));
  return partial;
}

Step DrivenCells::Advance(const State&, Partials& partials, const Inputs& inputs) const {
  const GridBox grid = GridIn(options_, inputs);
  std::vector<double> probability(static_cast<std::size_t>(grid.cells()),
                                  std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < partials.size(); ++k)
    for (const std::int64_t cell : partials.Get(k)->Get<std::int64_t>("cell")) {
      RequireWithin("a cell", cell, 0, grid.cells() - 1);
      probability[static_cast<std::size_t>(cell)] = options_.p_occupied;
    }
  Blob result;
  result.Put("map/grid/probability", Array::Of<double>({grid.rows, grid.columns}, probability));
  PutFields("map/grid/", kinds::GridPlace::Of(grid), &result);
  result.PutAll("", *inputs.Get("scan poses"));
  Step step;
  step.plan.set_result(step.Share(std::move(result)));
  return step;
}

}  // namespace cairn::driven_cells
