#include "pipelines/local_map/local_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "pipelines/local_map/corrected_path.h"
#include "pipelines/local_map/orientation_task.h"
#include "pipelines/local_map/plan.h"
#include "pipelines/local_map/sweep_reader.h"
#include "schema/error.h"

namespace cairn::local_map {
namespace {

PosedScans ReadScans(const Blob& log, const Blob& poses, const Options& options) {
  cairn::GridOptions reading;
  reading.sensors = options.sensors;
  reading.skip_unposed = true;
  return ReadRangeScans(log, &poses, reading);
}

std::string NoteOf(const std::vector<RobotRuns>& robots, std::size_t unposed) {
  std::size_t sweeps = 0, cuts = 0;
  for (const RobotRuns& runs : robots) {
    sweeps += runs.sweeps.size();
    cuts += runs.cuts.size();
  }
  return std::to_string(sweeps) + " sweeps" + (cuts > 0 ? ", cut " + std::to_string(cuts) + " times" : "") +
         (unposed > 0 ? ", " + std::to_string(unposed) + " scans without odometry left out" : "");
}

// Counts decay by sweeps; where these are far apart, what a robot saw a few metres ago would outlive many of
// a slow one's.
GridOptions OfSweeps(GridOptions options, double sweep_m) {
  constexpr double kUsual_m = 0.08;  // at 5 Hz and 0.4 m/s
  const double longer = std::max(1.0, sweep_m / kUsual_m);
  options.occupancy_kept = std::pow(options.occupancy_kept, longer);
  options.edges_kept = std::pow(options.edges_kept, longer);
  options.walls_kept = std::pow(options.walls_kept, longer);
  return options;
}

// Of those between which the robot moved, on average.
double WayOfSweep(const std::vector<Sweep>& sweeps) {
  constexpr double kMoves_m = 1e-3;
  double way_m = 0, moves = 0;
  for (std::size_t s = 1; s < sweeps.size(); ++s) {
    const double by_m = sweeps[s].path_m - sweeps[s - 1].path_m;
    if (by_m < kMoves_m) continue;
    way_m += by_m;
    ++moves;
  }
  return moves > 0 ? way_m / moves : 0;
}

Blob CutsBlob(const std::vector<Cut>& cuts) {
  std::vector<double> time;
  std::vector<std::string> why;
  for (const Cut& cut : cuts) {
    time.push_back(cut.time_s);
    why.push_back(cut.why);
  }
  Blob blob;
  blob.PutVector("time_s", time);
  blob.Put("why", Array::Texts(why));
  return blob;
}

}  // namespace

Step LocalMap::Start(const Inputs& inputs) const {
  const BlobPtr log = inputs.Get("log");
  const DeadReckoning reckoning = ReckonAll(*log, options_.runs);
  const PosedScans scans = ReadScans(*log, reckoning.poses, options_);
  const std::vector<RobotRuns> robots = RunsOf(scans, reckoning, options_.runs);
  Step step;
  State& state = *step.plan.mutable_state();
  (*state.mutable_scalars())[kPhase].set_s("walls");
  (*state.mutable_scalars())[kRobots].set_i(static_cast<std::int64_t>(robots.size()));
  auto& blobs = *state.mutable_blobs();
  blobs[kLogInput] = log->ContentHash().Binary();
  for (std::size_t r = 0; r < robots.size(); ++r) {
    blobs[RingsName(r)] = step.Share(RingsBlob(scans, robots[r].sensors));
    blobs[RowsName(r)] = step.Share(RowsOf(robots[r]));
    (*state.mutable_scalars())[SweepKey(r)].set_d(WayOfSweep(robots[r].sweeps));
    blobs[CutsName(r)] = step.Share(CutsBlob(robots[r].cuts));
    for (const Stretch& segment : SegmentsOf(r, robots[r].sweeps, options_))
      AddSweepTask("walls", segment, RowsName(r), &step.plan);
  }
  step.plan.set_note(NoteOf(robots, scans.unposed));
  return step;
}

Blob LocalMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  SweepReader sweeps(*inputs.Get("log"), *inputs.Get("rings"), *inputs.Get("rows"), options_.ring_beams);
  const auto own = static_cast<std::size_t>(task.params().at("own").i());
  const GridOptions grid = OfSweeps(options_.grid, task.params().at("sweep_m").d());
  Blob partial = WatchWalls(sweeps, own, grid, progress);
  partial.PutScalar("robot", task.params().at("robot").i());
  return partial;
}

namespace {

std::vector<std::vector<float>> EdgesOf(Partials& partials, std::size_t robots) {
  std::vector<std::vector<float>> edges(robots);
  for (std::size_t k = 0; k < partials.size(); ++k) {
    const BlobPtr partial = partials.Get(k);
    auto& of_robot = edges[static_cast<std::size_t>(partial->Scalar<std::int64_t>("robot"))];
    const auto more = partial->Get<float>("edges_m");
    of_robot.insert(of_robot.end(), more.begin(), more.end());
  }
  return edges;
}

std::vector<OrientationSight> SightsOf(const std::vector<Sweep>& sweeps, const std::vector<float>& edges) {
  std::vector<OrientationSight> sights(sweeps.size());
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    sights[s].path_m = sweeps[s].path_m;
    sights[s].heading_rad = sweeps[s].pose.heading_rad;
    std::copy_n(edges.begin() + static_cast<std::ptrdiff_t>(s * kBins), kBins, sights[s].edges_m.begin());
    sights[s].begins = s > 0 && sweeps[s].jumped;
  }
  return sights;
}

}  // namespace

Step LocalMap::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  const auto robots = static_cast<std::size_t>(state.scalars().at(kRobots).i());
  const std::vector<std::vector<float>> edges = EdgesOf(partials, robots);
  const std::string phase = state.scalars().at(kPhase).s();
  Step step;
  *step.plan.mutable_state() = state;
  auto& blobs = *step.plan.mutable_state()->mutable_blobs();
  std::string note;
  for (std::size_t r = 0; r < robots; ++r) {
    const std::string rows_name = phase == "walls" ? RowsName(r) : PathName(r);
    const BlobPtr rows = inputs.Get(rows_name);
    std::vector<Sweep> sweeps = SweepsOf(*rows);
    const OrientationTrack track = TrackOrientation(SightsOf(sweeps, edges[r]), options_.orientation);
    Correct(track, &sweeps);
    blobs[PathName(r)] = step.Share(WithPoses(*rows, sweeps));
    char text[160];
    std::snprintf(text, sizeof text, "odometry drifts by %.3f rad/m, %.1f%% of turns, %.3f rad/sqrt(m)",
                  track.drift_rad_per_m, 100 * track.turn_scale, track.walk_rad_per_sqrt_m);
    note += (note.empty() ? "" : "; ") + std::string(text);
    if (phase == "walls") {
      for (const Stretch& segment : SegmentsOf(r, sweeps, options_))
        AddSweepTask("walls", segment, PathName(r), &step.plan);
    }
  }
  step.plan.set_note(note);
  if (phase == "walls") {
    (*step.plan.mutable_state()->mutable_scalars())[kPhase].set_s("walls again");
    return step;
  }
  const BlobPtr log = inputs.Get("log");
  Blob result;
  result.Put("robots", log->at("robots"));
  result.Put("log_hash", Array::Text(log->Without("truth/").ContentHash().Hex()));
  result.PutVector<std::int32_t>("traces/first_z", {});
  for (std::size_t r = 0; r < robots; ++r) {
    const Blob* path = nullptr;
    for (const BlobPtr& blob : step.blobs)
      if (blob->ContentHash().Binary() == blobs[PathName(r)]) path = blob.get();
    const std::vector<Sweep> sweeps = SweepsOf(*path);
    std::vector<double> time, x, y, h;
    for (const Sweep& sweep : sweeps) {
      time.push_back(sweep.time_s);
      x.push_back(sweep.pose.x_m);
      y.push_back(sweep.pose.y_m);
      h.push_back(Wrapped(sweep.pose.heading_rad));
    }
    const std::string p = "robot/" + std::to_string(r) + "/poses/";
    result.PutVector(p + "time_s", time);
    result.PutVector(p + "x_m", x);
    result.PutVector(p + "y_m", y);
    result.PutVector(p + "heading_rad", h);
  }
  step.plan.set_result(step.Share(std::move(result)));
  return step;
}

}  // namespace cairn::local_map
