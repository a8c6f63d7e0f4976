#include "pipelines/forward_map/forward_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipelines/common/handed_over.h"
#include "pipelines/forward_map/advance.h"
#include "pipelines/forward_map/history.h"
#include "pipelines/forward_map/plan.h"
#include "pipelines/forward_map/result.h"
#include "pipelines/forward_map/tile_task.h"
#include "pipelines/forward_map/tiles.h"
#include "pipelines/forward_map/weigh.h"

namespace cairn::forward_map {
namespace {

constexpr double kBytesOfCrossing = 32;  // in a task of the search
constexpr double kCrossingsOfSlice = 3e5;
constexpr double kShares[kSplits] = {0.5, 0.35};
constexpr double kUsualSigma_m = 0.05;

SensorModel ModelOf(const Options& options, const RangeScans& sensor, const Blob& log) {
  SensorModel model{.p_hit = options.p_hit, .p_rand = options.p_rand, .p_lost = options.p_lost};
  const bool stated = sensor.opening_rad > 0 && log.Has("noise/sonar_m");
  const double usual_m = stated ? log.Scalar<double>("noise/sonar_m") : kUsualSigma_m;
  model.sigma_m = options.sigma_m > 0 ? options.sigma_m : std::max(usual_m, options.grid.cell_m / 2);
  model.no_echo_m = model.sigma_m;
  model.z_max_m = options.max_range_m > 0 ? options.max_range_m : sensor.max_range_m;
  return model;
}

PosedScans ReadScans(const Options& options, const Inputs& inputs) {
  const BlobPtr poses = inputs.Has("poses") ? inputs.Get("poses") : nullptr;
  return ReadRangeScans(*inputs.Get("log"), poses.get(), options.grid);
}

void CheckFailures(const Options& options) {
  if (options.p_rand + options.p_lost <= kMostFailures) return;
  throw InputError(fmt::format("p_rand = {:g} and p_lost = {:g} together are more than {:g}", options.p_rand,
                               options.p_lost, kMostFailures));
}

void CheckMemory(const Options& options) {
  const double mb = options.tile_mcrossings * kBytesOfCrossing * 1e6 / 1048576;
  if (mb <= static_cast<double>(options.grid.memory_mb)) return;
  throw InputError(
      fmt::format("a task of tile_mcrossings = {:g} million takes {:.0f} MiB, and memory_mb allows {}",
                  options.tile_mcrossings, std::floor(mb), options.grid.memory_mb));
}

void Share(const std::string& name, Blob blob, Step* step) {
  (*step->plan.mutable_state()->mutable_blobs())[name] = step->Share(std::move(blob));
}

void ShareSensors(const std::vector<RangeScans>& sensors, const Load& load, Step* step) {
  auto& scalars = *step->plan.mutable_state()->mutable_scalars();
  double readings = 0;
  for (const RangeScans& sensor : sensors)
    readings += static_cast<double>(sensor.scans() * sensor.beams.size());
  scalars[kSensors].set_i(static_cast<std::int64_t>(sensors.size()));
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const auto number = static_cast<std::int64_t>(k);
    Share(SensorBlobName(number), SensorBlob(sensors[k]), step);
    Share(ScansBlobName(number), ScansBlob(sensors[k]), step);
    const double of_scan = load.Sum() / readings * static_cast<double>(sensors[k].beams.size());
    scalars[ScansKey(number)].set_i(static_cast<std::int64_t>(sensors[k].scans()));
    const double scans = static_cast<double>(sensors[k].scans());
    const double slices = std::ceil(std::max(1.0, scans * of_scan / kCrossingsOfSlice));
    scalars[SliceKey(number)].set_i(static_cast<std::int64_t>(std::ceil(scans / slices)));
  }
}

std::vector<RangeScans> SensorsOf(const Task& task, const Inputs& inputs, const MapState& map) {
  const auto count = static_cast<std::int64_t>(map.models.size());
  std::vector<RangeScans> sensors;
  for (std::int64_t k = 0; k < IntegerOf(task, kSensors, count, count); ++k)
    sensors.push_back(
        ScansOf(*inputs.Get(SensorBlobName(k)), *inputs.Get(ScansBlobName(k)), *inputs.Get(kLogBlob)));
  return sensors;
}

Blob RunTile(const Options& options, const Task& task, const Inputs& inputs, Progress& progress) {
  const MapState map = MapIn(options.grid, inputs);
  const std::vector<Tile> tiles = RowsIn<Tile>(*inputs.Get("tiles"));
  const auto last = static_cast<std::int64_t>(tiles.size()) - 1;
  const Tile& tile = tiles[static_cast<std::size_t>(IntegerOf(task, "tile", 0, last))];
  tile.Check(map.box);
  const std::vector<RangeScans> sensors = SensorsOf(task, inputs, map);
  if (task.kind() == "certainty") return BlobOf(CertaintyOfTile(options, map, tile, sensors, progress));
  const bool first = IntegerOf(task, "searches", 0, std::numeric_limits<std::int32_t>::max()) == 1;
  const Elsewhere elsewhere = first ? Elsewhere::kExplained : Elsewhere::kAsInTheMap;
  return ToBlob({SearchTile(options, map, tile, sensors, elsewhere, progress)});
}

Blob RunScans(const Options& options, const Task& task, const Inputs& inputs, Progress& progress) {
  MapState map = MapIn(options.grid, inputs);
  const std::int64_t sensor = IntegerOf(task, "sensor", 0, static_cast<std::int64_t>(map.models.size()) - 1);
  const RangeScans scans = ScansOf(*inputs.Get("sensor"), *inputs.Get("scans"), *inputs.Get(kLogBlob));
  const SensorModel& model = map.models[static_cast<std::size_t>(sensor)];
  if (task.kind() == "explain") {
    Blob blob;
    blob.Put("cause",
             Array::Of<std::int32_t>(
                 {static_cast<std::int64_t>(scans.scans()), static_cast<std::int64_t>(scans.beams.size())},
                 ExplainAll(scans, map.box, map.occupied, model, options.no_echo, progress)));
    return blob;
  }
  const std::int64_t taken = IntegerOf(task, "taken", 0, std::numeric_limits<std::int32_t>::max());
  if (taken > 0)
    Apply(ProposalsOf(*inputs.Get(kProposalsBlob)), static_cast<std::size_t>(taken), &map.occupied);
  Blob blob = BlobOf(Weigh(scans, 0, scans.scans(), map.box, map.occupied, model, options.no_echo, progress));
  blob.PutScalar("sensor", sensor);
  return blob;
}

std::string StartNote(const PosedScans& scans, const GridBox& box, std::size_t tiles) {
  std::size_t readings = 0;
  for (const RangeScans& sensor : scans.sensors) readings += sensor.scans() * sensor.beams.size();
  return fmt::format(
      "{} readings, {} x {} cells, {} tiles{}", readings, box.columns, box.rows, tiles,
      scans.unposed > 0 ? (", " + std::to_string(scans.unposed) + " scans without pose").c_str() : "");
}

}  // namespace

Step ForwardMap::Start(const Inputs& inputs) const {
  CheckFailures(options_);
  CheckMemory(options_);
  const PosedScans scans = ReadScans(options_, inputs);
  MapState map{GridOf(scans, options_.grid, kBytesOfCell), {}, {}};
  map.occupied.resize(static_cast<std::size_t>(map.box.cells()));
  double beyond_m = 0;
  for (const RangeScans& sensor : scans.sensors) {
    map.models.push_back(ModelOf(options_, sensor, *inputs.Get("log")));
    beyond_m = std::max(beyond_m, kReach * map.models.back().sigma_m);
  }
  const Load load = EstimateLoad(scans.sensors, map.box, beyond_m);
  Step step;
  (*step.plan.mutable_state()->mutable_blobs())[kLogBlob] = inputs.Get("log")->ContentHash().Binary();
  ShareSensors(scans.sensors, load, &step);
  std::size_t tiles = 0;
  for (std::int64_t split = 0; split < kSplits; ++split) {
    const std::vector<Tile> cut = CutTiles(load, options_.tile_mcrossings * 1e6, kShares[split]);
    Share(TilesBlob(split), BlobOf(cut), &step);
    (*step.plan.mutable_state()->mutable_scalars())[TilesKey(split)].set_i(
        static_cast<std::int64_t>(cut.size()));
    tiles = std::max(tiles, cut.size());
  }
  Share(kMapBlob, BlobOf(map), &step);
  (*step.plan.mutable_state()->mutable_scalars())[kCrossings].set_d(load.Sum());
  PutScalars(Schedule(), "", step.plan.mutable_state());
  PlanTasks(&step.plan);
  step.plan.set_note(StartNote(scans, map.box, tiles));
  ExpectRest(options_.rounds, options_.estimate, &step.plan);
  return step;
}

Blob ForwardMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  RequireKind(task, {"search", "certainty", "explain", "weigh"});
  const bool of_tile = task.kind() == "search" || task.kind() == "certainty";
  return of_tile ? RunTile(options_, task, inputs, progress) : RunScans(options_, task, inputs, progress);
}

Step ForwardMap::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  if (ScalarsIn<Schedule>(state).phase != Phase::kCertainty)
    return AdvanceSearch(options_, state, partials, inputs);
  Step step;
  *step.plan.mutable_state() = state;
  step.plan.set_result(
      step.Share(ResultOf(options_, ReadScans(options_, inputs), *inputs.Get("log"),
                          MapIn(options_.grid, inputs), RowsIn<Tile>(*inputs.Get(TilesBlob(0))),
                          *inputs.Get(kHistoryBlob), ScalarsIn<Schedule>(state), partials)));
  const Schedule schedule = ScalarsIn<Schedule>(state);
  step.plan.set_note(schedule.cut_short ? "done; cut short after " + std::to_string(schedule.searches) +
                                              " searches, all that 'rounds' allows"
                                        : "done");
  return step;
}

}  // namespace cairn::forward_map
