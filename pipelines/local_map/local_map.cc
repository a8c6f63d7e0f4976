#include "pipelines/local_map/local_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/common/handed_over.h"
#include "pipelines/local_map/advance.h"
#include "pipelines/local_map/path/laser_agreement.h"
#include "pipelines/local_map/plan.h"
#include "pipelines/local_map/size.h"
#include "pipelines/local_map/tasks/follow_task.h"
#include "pipelines/local_map/tasks/orientation_task.h"
#include "pipelines/local_map/tasks/pass_task.h"
#include "pipelines/local_map/tasks/scan_reader.h"
#include "schema/error.h"
#include "schema/kinds/local_map.h"

namespace cairn::local_map {
namespace {

PosedScans ReadScans(const Blob& log, const Blob& poses, const Options& options) {
  cairn::GridOptions reading;
  reading.sensors = options.sensors;
  reading.skip_unposed = true;
  return ReadRangeScans(log, &poses, reading);
}

void RequireRanges(const Blob& log) {
  for (const auto& [name, array] : log.fields())
    if (name.starts_with("robot/") && name.ends_with("/range_m") && array.shape().size() == 2) return;
  throw InputError("the log has no range scans: a local map is made of sonar, infra-red or laser");
}

// Lines are looked for among pairs of a scan's ends: a scan of millions would hold a worker for hours.
void RequireFewBeams(const PosedScans& scans, const RobotRuns& robot) {
  constexpr std::size_t kMostBeams = 20'000;
  std::size_t beams = 0;
  for (const std::size_t s : robot.sensors) beams += scans.sensors[s].beams.size();
  if (beams <= kMostBeams) return;
  throw InputError("'" + scans.sensors[robot.sensors.front()].name + "': a scan of " + std::to_string(beams) +
                   " beams; a local map takes at most " + std::to_string(kMostBeams) +
                   " of a robot's sensors together: leave out most of them");
}

std::string NoteOf(const std::vector<RobotRuns>& robots, std::size_t unposed, const Size& size) {
  std::size_t scans = 0, cuts = 0;
  for (const RobotRuns& runs : robots) {
    scans += runs.scans.size();
    cuts += runs.cuts.size();
  }
  return std::to_string(scans) + " scans" + (cuts > 0 ? ", cut " + std::to_string(cuts) + " times" : "") +
         (unposed > 0 ? ", " + std::to_string(unposed) + " scans without odometry left out" : "") +
         fmt::format(", grids that reach {:.2f} m", size.reach_m());
}

Blob CutsBlob(const std::vector<Cut>& cuts) {
  return BlobOf(kinds::LocalMap::Cuts{cairn::ColumnOf(cuts, &Cut::time_s), cairn::ColumnOf(cuts, &Cut::why)});
}

}  // namespace

Step LocalMap::Start(const Inputs& inputs) const {
  const BlobPtr log = inputs.Get("log");
  RequireRanges(*log);
  const DeadReckoning reckoning = ReckonAll(*log, options_.runs);
  const PosedScans scans = ReadScans(*log, reckoning.poses, options_);
  const std::vector<RobotRuns> robots = CutRuns(scans, reckoning, options_.runs);
  for (const RobotRuns& robot : robots) RequireFewBeams(scans, robot);
  Step step;
  State& state = *step.plan.mutable_state();
  Standing standing{.robots = static_cast<std::int64_t>(robots.size())};
  const Size size = ChooseSize(options_, scans, robots);
  PutScalars(size, "", &state);
  auto& blobs = *state.mutable_blobs();
  blobs[kLogInput] = log->ContentHash().Binary();
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const Blob rings = RingsBlob(scans, robots[r].sensors);
    standing.lasers += LasersIn(rings) > 0;
    blobs[RingsName(r)] = step.Share(rings);
    blobs[RowsName(r)] = step.Share(RowsOf(robots[r]));
    blobs[CutsName(r)] = step.Share(CutsBlob(robots[r].cuts));
    PlanWalls(r, robots[r].scans, options_, &step.plan);
  }
  PutScalars(standing, "", &state);
  double scan_count = 0;
  for (const RobotRuns& runs : robots) scan_count += static_cast<double>(runs.scans.size());
  ExpectRest(options_, scan_count, -1, &step.plan);
  step.plan.set_note(NoteOf(robots, scans.unposed, size));
  return step;
}

namespace {

constexpr std::int64_t kMostScans = std::numeric_limits<std::int32_t>::max();

std::size_t RobotOf(const Task& task) {
  return static_cast<std::size_t>(IntegerOf(task, "robot", 0, kMostScans));
}

// The first scan that is the task's own: those before it lead up to it.
std::size_t OwnOf(const Task& task, const ScanReader& scans) {
  return static_cast<std::size_t>(IntegerOf(task, "own", 0, static_cast<std::int64_t>(scans.size())));
}

Blob RecordTraces(const Task& task, const Inputs& inputs, const GridOptions& grid, ScanReader* scans,
                  Progress& progress, const RecordOptions& options) {
  const auto first = static_cast<std::size_t>(IntegerOf(task, "first", 0, kMostScans));
  const std::size_t own = OwnOf(task, *scans), robot = RobotOf(task);
  std::vector<std::int64_t> nodes;
  if (inputs.Has("nodes")) {
    const BlobPtr blob = inputs.Get("nodes");
    RequireAllWithin("a node's scan", blob->Get<std::int64_t>("scan"), std::int64_t{0}, kMostScans);
    for (const std::int64_t scan : blob->Get<std::int64_t>("scan"))
      nodes.push_back(scan - static_cast<std::int64_t>(first));
  }
  const auto hints =
      Column<double>::In(*inputs.Get("log"), "robot/" + std::to_string(robot) + "/hints/time_s");
  Recorded recorded = Record(*scans, own, nodes, hints.OrNone(), grid, options, progress);
  for (RecordedTrace& trace : recorded.traces) {
    trace.robot = robot;
    trace.first += first;
    trace.end += first;
  }
  Blob partial = TracesBlob(recorded.traces);
  Blob snapshot;
  recorded.snapshot.Put(&snapshot);
  partial.PutAll("snapshot/", snapshot);
  partial.PutScalar("last", static_cast<std::int64_t>(first + scans->size()) - 1);
  partial.PutVector("node_features", recorded.nodes.features);
  partial.PutVector("node_robot", recorded.nodes.robot);
  return partial;
}

Blob FollowAll(const Task& task, const Inputs& inputs, const Options& options, ScanReader* scans,
               Progress& progress) {
  const std::vector<Scan> rows = RowsIn<Scan>(*inputs.Get("rows"));
  std::vector<double> moved_m(rows.size());
  for (std::size_t s = 1; s < rows.size(); ++s) {
    if (rows[s].run == rows[s - 1].run) continue;
    moved_m[s] = rows[s].jumped ? options.nodes.jump_m : options.nodes.gap_m;
  }
  RequireSize("rows", rows.size(), scans->size());
  const std::vector<RecordedTrace> traces = ReadTraces(*inputs.Get("traces"), options.grid.cell_m);
  const std::vector<Connection> connections = RowsIn<Connection>(*inputs.Get("connections"));
  for (const Connection& connection : connections) connection.Check(traces.size());
  Blob partial;
  partial.PutAll("positions/", Follow(*scans, RobotOf(task), traces, connections, moved_m, options.grid,
                                      options.localizer, progress));
  return partial;
}

// FORMAT.md's lasers/.
Blob CompareAll(const Inputs& inputs, ScanReader* scans, Progress& progress) {
  const std::vector<Scan> rows = RowsIn<Scan>(*inputs.Get("rows"));
  RequireSize("rows", rows.size(), scans->size());
  const std::vector<LaserAgreement> all = CompareLasers(
      scans->beams(), rows, [&](std::size_t s) { return scans->Read(s); }, [&] { progress.Tick(); });
  const auto name = [&](std::int32_t ring) { return scans->SensorName(static_cast<std::size_t>(ring)); };
  kinds::LocalMap::Lasers lasers;
  lasers.first = cairn::ColumnOf(all, [&](const LaserAgreement& a) { return name(a.first); });
  lasers.second = cairn::ColumnOf(all, [&](const LaserAgreement& a) { return name(a.second); });
  lasers.looked = cairn::ColumnOf(all, &LaserAgreement::looked);
  lasers.share = cairn::ColumnOf(all, &LaserAgreement::share);
  lasers.moved_looked = cairn::ColumnOf(all, &LaserAgreement::moved_looked);
  lasers.moved_share = cairn::ColumnOf(all, &LaserAgreement::moved_share);
  lasers.moved_m = cairn::ColumnOf(all, &LaserAgreement::moved_m);
  lasers.moved_rad = cairn::ColumnOf(all, &LaserAgreement::moved_rad);
  Blob partial;
  if (!all.empty()) partial.PutAll("lasers/", BlobOf(lasers));
  return partial;
}

}  // namespace

Blob LocalMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  RequireKind(task, {"pairs", "walls", "traces", "lasers", "passes", "follow"});
  const Options options = Sized(options_, SizeOf(task));
  if (task.kind() == "pairs") return MatchPairs(inputs, options, progress);
  ScanReader scans(*inputs.Get("log"), *inputs.Get("rings"), *inputs.Get("rows"), options.ring_beams);
  Blob partial;
  if (task.kind() == "walls") {
    std::optional<std::size_t> ahead;
    if (task.params().contains("motion"))
      ahead = static_cast<std::size_t>(IntegerOf(task, "motion", 0, kMostScans));
    partial = WatchWalls(scans, OwnOf(task, scans), ahead, options.grid, progress);
    const std::int64_t first = IntegerOf(task, "first", 0, kMostScans);
    partial.PutScalar("first", first);
    partial.PutScalar("own", first + static_cast<std::int64_t>(OwnOf(task, scans)));
  } else if (task.kind() == "traces") {
    partial = RecordTraces(task, inputs, options.grid, &scans, progress, options.record);
  } else if (task.kind() == "lasers") {
    partial = CompareAll(inputs, &scans, progress);
  } else if (task.kind() == "passes") {
    const std::vector<Scan> rows = RowsIn<Scan>(*inputs.Get("rows"));
    RequireSize("rows", rows.size(), scans.size());
    partial.PutAll("passes/", WatchPasses(scans, rows, progress));
  } else {
    partial = FollowAll(task, inputs, options, &scans, progress);
  }
  partial.PutScalar("robot", static_cast<std::int64_t>(RobotOf(task)));
  return partial;
}

Step LocalMap::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  return AdvanceLocalMap(Sized(options_, ScalarsIn<Size>(state)), state, partials, inputs);
}

}  // namespace cairn::local_map
