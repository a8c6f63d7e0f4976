// A corridor with doors, recesses and cupboards, and a robot that drives along it with a little odometric
// error: for what matching of traces achieves.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "pipelines/local_map/testing/drive.h"
#include "pipelines/local_map/traces/correlation.h"
#include "pipelines/local_map/traces/recorder.h"

namespace cairn::local_map {

using Walls = std::vector<TestWall>;

inline void AddBox(Walls& walls, double x0, double y0, double x1, double y1) {
  walls.push_back({{x0, y0}, {x1, y0}});
  walls.push_back({{x1, y0}, {x1, y1}});
  walls.push_back({{x1, y1}, {x0, y1}});
  walls.push_back({{x0, y1}, {x0, y0}});
}

// One wall along y = side * half with openings of doors, some of them closed in a recess.
inline void AddSide(Walls& walls, double length_m, double side, double half_m, Rng& rng) {
  double x = 0;
  while (x < length_m) {
    const double next = std::min(length_m, x + rng.Uniform(1.2, 4));
    walls.push_back({{x, side * half_m}, {next, side * half_m}});
    if (next >= length_m) break;
    const double end = next + 0.95, depth = rng.Uniform() < 0.5 ? 0.12 : 3;
    walls.push_back({{next, side * half_m}, {next, side * (half_m + depth)}});
    walls.push_back({{end, side * half_m}, {end, side * (half_m + depth)}});
    walls.push_back({{next, side * (half_m + depth)}, {end, side * (half_m + depth)}});
    x = end;
  }
}

inline Walls Building(std::uint64_t seed, double length_m) {
  Rng rng(seed, 1);
  Walls walls;
  const double half_m = rng.Uniform(0.9, 1.5);
  AddSide(walls, length_m, 1, half_m, rng);
  AddSide(walls, length_m, -1, half_m, rng);
  walls.push_back({{0, -half_m}, {0, half_m}});
  walls.push_back({{length_m, -half_m}, {length_m, half_m}});
  return walls;
}

// Cupboards along the walls of that building; others in another `arrangement`.
inline void AddFurniture(Walls& walls, std::uint64_t seed, int arrangement, double length_m) {
  Rng width(seed, 1), rng(seed, 2, static_cast<std::uint32_t>(arrangement));
  const double half_m = width.Uniform(0.9, 1.5);
  for (double x = 1 + rng.Uniform(0, 2); x + 1.5 < length_m; x += rng.Uniform(2, 5)) {
    const double side = rng.Uniform() < 0.5 ? -1 : 1, deep = rng.Uniform(0.2, 0.45);
    AddBox(walls, x, side * half_m, x + rng.Uniform(0.5, 1.3), side * (half_m - deep));
  }
}

// Where the robot believed to be and where it was, scan by scan; what it recorded, what was around it.
struct Pass {
  EdgeTrace trace;
  TraceFrame frame;
  std::vector<double> true_x_m, true_y_m;
  std::vector<Position> in_trace;  // by its odometry
  std::vector<ImmediateTrace> now;
  GridMap map{0.15, -20, 160, 25};  // the baseline's
  std::vector<GridMap> grids_now;
};

// One drive along the corridor at y = `y_m` (y_m the other way, `back`). A heading error of up to half a
// degree and one of scale of up to a hundredth stay. `look` sees the grids after each scan.
inline Pass DriveAlong(const Walls& walls, double length_m, double y_m, bool back, std::uint64_t seed,
                       const std::function<void(const LocalGrids&, const TraceRecorder&)>& look = {}) {
  Rng rng(seed, 3);
  const double heading_error = rng.Uniform(-0.5, 0.5) * std::numbers::pi / 180,
               scale = 1 + rng.Uniform(-0.01, 0.01);
  LocalGrids grids(Drive::Fixed(), {SensorRing(RingBeams(), kTestOpeningRad, 6)});
  TraceRecorder recorder(grids);
  Pass pass;
  bool begun = false;
  for (double travelled = 0.5; travelled < length_m - 0.7; travelled += Drive::kSpeedMS * Drive::kScanS) {
    const double weave = 0.05 * std::sin(travelled);
    const Pose truth{back ? length_m - travelled : travelled, y_m + weave, back ? std::numbers::pi : 0};
    const double turret = 0.8 * std::sin(travelled / Drive::kSpeedMS);
    const auto ranges = SonarScan(walls, truth, turret, rng);
    const Pose odometry{std::cos(heading_error) * travelled * scale,
                        std::sin(heading_error) * travelled + (back ? -weave : weave), 0};
    const RingScan scan{travelled / Drive::kSpeedMS, turret, ranges};
    grids.Update(odometry, std::span(&scan, 1));
    if (travelled > 1 && !begun) {
      recorder.Begin(grids, scan.time_s);
      begun = true;
    }
    if (!begun) continue;
    recorder.Update(grids, scan.time_s);
    if (look) look(grids, recorder);
    pass.map.Add(grids, recorder.frame());
    pass.grids_now.push_back(MapOfNow(grids, recorder.frame().quarter));
    pass.true_x_m.push_back(truth.x_m);
    pass.true_y_m.push_back(truth.y_m);
    pass.in_trace.push_back(recorder.RobotAt(grids));
    pass.now.push_back(ImmediateRoom(grids));
    MakeImmediate(grids, recorder.frame().quarter, pass.now.back());
  }
  pass.trace = recorder.trace();
  pass.frame = recorder.frame();
  return pass;
}

// Where somebody at (x, y) stands in the pass's trace: by its odometry when it was nearest.
inline Position TruthIn(const Pass& pass, double x_m, double y_m) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < pass.true_x_m.size(); ++k)
    if (std::abs(pass.true_x_m[k] - x_m) < std::abs(pass.true_x_m[best] - x_m)) best = k;
  const bool back = pass.true_x_m.front() > pass.true_x_m.back();
  const double sign = back ? -1 : 1;
  return {pass.in_trace[best].z_m + sign * (x_m - pass.true_x_m[best]),
          pass.in_trace[best].u_m + sign * (y_m - pass.true_y_m[best])};
}

}  // namespace cairn::local_map
