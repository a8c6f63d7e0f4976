#include "pipelines/evidence_map/evidence_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "pipelines/common/checked_readings.h"
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
// Where maps of both kinds of sensors, of the scans that the map is checked with, and the result are at hand.
constexpr double kBytesPerCell = 72;

// In a task's partial, the counts of those scans that the map is checked with.
constexpr const char* kCheckedCounts = "checked/";

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

Counts CountsOf(const Options& options, const RangeScans& scans, const GridBox& grid, Progress& progress) {
  return scans.opening_rad > 0
             ? CountCones(scans, grid, {options.wall_m, options.graded}, options.use_no_return, progress)
             : CountRays(scans, grid, options.use_no_return, progress);
}

// Adds up partials of counts: those of rays and those of cones.
class Sums {
 public:
  Sums(const Options& options, const GridBox& grid) : options_(options), grid_(grid) {}

  void Add(const Blob& partial, bool is_of_cones) {
    const auto cells = static_cast<std::size_t>(grid_.cells());
    Totals& sum = totals_[is_of_cones ? 1 : 0];
    if (sum.free.empty()) sum = {std::vector<std::int64_t>(cells), std::vector<std::int64_t>(cells)};
    AddTo(grid_, partial, &sum);
  }

  void TakeAway(const Sums& part) {
    const auto take = [](std::vector<std::int64_t>* from, const std::vector<std::int64_t>& what) {
      for (std::size_t k = 0; k < what.size(); ++k) (*from)[k] -= what[k];
    };
    for (std::size_t kind = 0; kind < totals_.size(); ++kind) {
      take(&totals_[kind].free, part.totals_[kind].free);
      take(&totals_[kind].occupied, part.totals_[kind].occupied);
    }
  }

  std::vector<double> LogOdds() const {
    std::vector<Evidence> evidence;
    if (!totals_[0].free.empty()) evidence.push_back({totals_.data(), options_.laser, 1});
    if (!totals_[1].free.empty()) evidence.push_back({&totals_[1], options_.sonar, kWhole});
    return LogOddsOf(evidence, static_cast<std::size_t>(grid_.cells()), options_.prior, options_.clamp_nats);
  }

 private:
  const Options& options_;
  const GridBox& grid_;
  std::array<Totals, 2> totals_;  // of rays, of cones
};

// What readings of the sensor are like: [Thr01]'s figures, as forward_map begins with them.
ReadingModel ModelOf(const Options& options, const RangeScans& sensor, const Blob& log) {
  ReadingModel model;
  const bool stated = sensor.opening_rad > 0 && log.Has("noise/sonar_m");
  model.sigma_m =
      std::max(stated ? log.Scalar<double>("noise/sonar_m") : model.sigma_m, options.grid.cell_m / 2);
  model.no_echo_m = model.sigma_m;
  model.z_max_m = sensor.max_range_m;
  model.no_echo = options.use_no_return;
  return model;
}

// Of a map without the scans that it is checked with.
CheckedReadings CheckOf(const Options& options, const PosedScans& scans, const Blob& log, const GridBox& grid,
                        std::vector<double> log_odds) {
  for (double& l : log_odds) l = std::isnan(l) ? l : Probability(l);
  CheckedReadings all;
  for (const RangeScans& sensor : scans.sensors)
    all.Add(Check(sensor, grid, log_odds, ModelOf(options, sensor, log)));
  return all;
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

Blob EvidenceMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  RequireKind(task, {"counts"});
  RangeScans scans = ScansOf(*inputs.Get("sensor"), *inputs.Get("scans"), *inputs.Get("log"));
  const GridBox grid = GridIn(inputs, options_);
  const bool cone = scans.opening_rad > 0;
  Blob partial = ToBlob(CountsOf(options_, scans, grid, progress));
  partial.PutScalar<std::uint8_t>("cone", cone ? 1 : 0);
  const RangeScans checked = CheckedOnly(std::move(scans));
  if (std::ranges::find(checked.held_out, 0) != checked.held_out.end())
    partial.PutAll(kCheckedCounts, ToBlob(CountsOf(options_, checked, grid, progress)));
  return partial;
}

Step EvidenceMap::Advance(const State&, Partials& partials, const Inputs& inputs) const {
  const GridBox grid = GridIn(inputs, options_);
  Sums sums(options_, grid);
  auto of_checked = std::make_unique<Sums>(options_, grid);
  for (std::size_t k = 0; k < partials.size(); ++k) {
    const BlobPtr partial = partials.Get(k);
    const bool is_of_cones = partial->Scalar<std::uint8_t>("cone") != 0;
    sums.Add(*partial, is_of_cones);
    const Blob checked = partial->Sub(kCheckedCounts);
    if (!checked.fields().empty()) of_checked->Add(checked, is_of_cones);
  }
  std::vector<double> log_odds = sums.LogOdds();
  sums.TakeAway(*of_checked);
  of_checked.reset();
  Blob result = ResultOf(grid, std::exchange(log_odds, {}));
  result.PutAll("", *inputs.Get("scan poses"));
  BlobPtr keep;
  const BlobPtr log = inputs.Get("log");
  const PosedScans scans = ReadRangeScans(*log, PosesOf(inputs, &keep), options_.grid);
  PutCheck(CheckOf(options_, scans, *log, grid, sums.LogOdds()), &result);
  Step step;
  step.plan.set_result(step.Share(std::move(result)));
  return step;
}

}  // namespace cairn::evidence_map
