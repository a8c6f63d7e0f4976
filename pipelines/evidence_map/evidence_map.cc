#include "pipelines/evidence_map/evidence_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/task_builder.h"
#include "pipelines/evidence_map/cone_counts.h"
#include "pipelines/evidence_map/log_odds.h"
#include "pipelines/evidence_map/ray_counts.h"
#include "schema/kinds/grid_map.h"

namespace cairn::evidence_map {
namespace {

// Each task brings home a map, so there are no more of a sensor than some, but for logs so long that tasks
// would take long: from 10 ms to a quarter of a second of a core.
constexpr double kTasks = 12, kLeastCells = 1 << 23, kMostCells = 1 << 28;
// A slice begins at such a scan alone: there its ranges, of eight bytes, are aligned however many beams there
// are, and need no copy.
constexpr std::size_t kScansTogether = 8;
constexpr double kBytesPerCell = 64;  // where maps of both kinds of sensors and the result are at hand

// Microseconds of a core: a cell that a task goes over, by rays and by cones; one of its map; one of it that
// is added up, and one of the result.
constexpr double kRayUs = 1e-3, kConeUs = 0.15, kMapUs = 0.025, kAddedUs = 0.01, kResultUs = 0.1;

// About how many cells a scan tells of.
double WorkOf(const RangeScans& scans, std::size_t scan, double cell_m) {
  const std::size_t beams = scans.beams.size();
  const auto range = scans.range_m.As<double>().subspan(scan * beams, beams);
  double cells = 0;
  for (const double measured : range) {
    const double length = (std::isnan(measured) ? scans.max_range_m : measured) / cell_m;
    cells += 1 + length * (1 + scans.opening_rad / 2 * length);
  }
  return cells;
}

// Its scans in a blob of their own: no worker fetches more for a task than that needs, nor waits for more.
void AddTask(const std::string& log, const std::string& sensor, const Blob& scans, std::size_t first,
             std::size_t count, double cost, Step* step) {
  Blob rows;
  for (const auto& [name, array] : scans.fields())
    rows.Put(name, array.Rows(static_cast<std::int64_t>(first), static_cast<std::int64_t>(count)));
  const std::string of_task = step->Share(std::move(rows));
  TaskBuilder("counts", cost, &step->plan)
      .ReadHash("sensor", sensor)
      .ReadHash("scans", of_task)
      .Read("grid")
      .ReadHash("log", log);
}

// Time slices of about equal work.
void AddTasks(const std::string& log, const RangeScans& scans, const GridBox& grid, Step* step) {
  std::vector<double> work;
  double all = 0;
  for (std::size_t s = 0; s < scans.scans(); ++s) all += work.emplace_back(WorkOf(scans, s, grid.cell_m));
  const double of_a_task = std::clamp(all / kTasks, kLeastCells, kMostCells);
  const std::string sensor = step->Share(SensorBlob(scans));
  const Blob rows = ScansBlob(scans);
  double sum = 0;
  std::size_t first = 0;
  for (std::size_t s = 0; s < scans.scans(); ++s) {
    sum += work[s];
    if ((sum < of_a_task || (s + 1) % kScansTogether != 0) && s + 1 < scans.scans()) continue;
    const double cost =
        (scans.opening_rad > 0 ? kConeUs : kRayUs) * sum + kMapUs * static_cast<double>(grid.cells());
    AddTask(log, sensor, rows, first, s + 1 - first, cost, step);
    first = s + 1;
    sum = 0;
  }
}

GridBox GridIn(const Inputs& inputs, const Options& options) {
  const auto grid = cairn::Read<GridBox>(*inputs.Get("grid"));
  RequireGrid(grid, MostCells(options.grid, kBytesPerCell));
  return grid;
}

const Blob* PosesOf(const Inputs& inputs, BlobPtr* keep) {
  if (inputs.Has("poses")) *keep = inputs.Get("poses");
  return keep->get();
}

Blob ResultOf(const GridBox& grid, const std::vector<double>& log_odds) {
  std::vector<double> probability;
  std::vector<float> stored;
  probability.reserve(log_odds.size());
  stored.reserve(log_odds.size());
  for (const double l : log_odds) {
    probability.push_back(std::isnan(l) ? l : Probability(l));
    stored.push_back(static_cast<float>(l));
  }
  const Shape shape{grid.rows, grid.columns};
  kinds::GridMap map;
  map.grid = {kinds::GridPlace::Of(grid), {shape, probability}, {}, {shape, stored}, {}, {}};
  return BlobOf(map);
}

std::string NoteOf(const PosedScans& scans, const GridBox& grid) {
  std::size_t count = 0;
  for (const RangeScans& sensor : scans.sensors) count += sensor.scans();
  std::string note = std::to_string(count) + " scans, " + std::to_string(grid.columns) + " by " +
                     std::to_string(grid.rows) + " cells";
  if (scans.unposed > 0) note += "; " + std::to_string(scans.unposed) + " scans without a pose left out";
  return note;
}

}  // namespace

Step EvidenceMap::Start(const Inputs& inputs) const {
  BlobPtr keep;
  const BlobPtr log = inputs.Get("log");
  const PosedScans scans = ReadRangeScans(*log, PosesOf(inputs, &keep), options_.grid);
  const GridBox grid = GridOf(scans, options_.grid, kBytesPerCell);
  Step step;
  Blob box, poses;
  PutFields("", grid, &box);
  PutScanPoses(scans, *log, &poses);
  auto& blobs = *step.plan.mutable_state()->mutable_blobs();
  blobs["grid"] = step.Share(std::move(box));
  blobs["scan poses"] = step.Share(std::move(poses));
  const std::string log_hash = log->ContentHash().Binary();
  for (const RangeScans& sensor : scans.sensors) AddTasks(log_hash, sensor, grid, &step);
  step.plan.set_advance_cost(static_cast<double>(grid.cells()) *
                             (kAddedUs * step.plan.tasks_size() + kResultUs));
  step.plan.set_note(NoteOf(scans, grid));
  return step;
}

Blob EvidenceMap::Run(const Task&, const Inputs& inputs, Progress& progress) const {
  const RangeScans scans = ScansOf(*inputs.Get("sensor"), *inputs.Get("scans"), *inputs.Get("log"));
  const GridBox grid = GridIn(inputs, options_);
  const bool cone = scans.opening_rad > 0;
  const Counts counts =
      cone ? CountCones(scans, grid, {options_.wall_m, options_.graded}, options_.use_no_return, progress)
           : CountRays(scans, grid, options_.use_no_return, progress);
  Blob partial = ToBlob(counts);
  partial.PutScalar<std::uint8_t>("cone", cone ? 1 : 0);
  return partial;
}

Step EvidenceMap::Advance(const State&, Partials& partials, const Inputs& inputs) const {
  const GridBox grid = GridIn(inputs, options_);
  const auto cells = static_cast<std::size_t>(grid.cells());
  std::array<Totals, 2> totals;  // of rays, of cones
  for (std::size_t k = 0; k < partials.size(); ++k) {
    const BlobPtr partial = partials.Get(k);
    Totals& sum = totals[partial->Scalar<std::uint8_t>("cone") != 0 ? 1 : 0];
    if (sum.free.empty()) sum = {std::vector<std::int64_t>(cells), std::vector<std::int64_t>(cells)};
    AddTo(grid, *partial, &sum);
  }
  std::vector<Evidence> evidence;
  if (!totals[0].free.empty()) evidence.push_back({&totals[0], options_.laser, 1});
  if (!totals[1].free.empty()) evidence.push_back({&totals[1], options_.sonar, kWhole});
  Blob result = ResultOf(grid, LogOddsOf(evidence, cells, options_.prior, options_.clamp_nats));
  result.PutAll("", *inputs.Get("scan poses"));
  Step step;
  step.plan.set_result(step.Share(std::move(result)));
  return step;
}

}  // namespace cairn::evidence_map
