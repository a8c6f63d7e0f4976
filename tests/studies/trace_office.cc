// How well traces are matched in simulated offices: what was around the robot at places, sought on the traces
// of other times.
//   trace_office RANGE_M LOG.h5 ...        of `cairn simulate office`
// Grids are fed with the true headings and with ways that drift as odometry's do.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include "pipelines/common/odometry.h"
#include "pipelines/local_map/traces/find_on.h"
#include "pipelines/local_map/traces/recorder.h"
#include "schema/rng.h"
#include "schema/store/blob_file.h"
#include "tests/bench/bench_main.h"
#include "tests/studies/trace_errors.h"

namespace cairn::local_map {
namespace {

struct Ring {
  explicit Ring(const Blob& robot, const std::string& name) : sensor(robot.Sub(name + "/")) {}
  Blob sensor;

  SensorRing ToRing() const {
    const auto x = sensor.Get<double>("beam_x_m"), y = sensor.Get<double>("beam_y_m"),
               heading = sensor.Get<double>("beam_heading_rad");
    std::vector<Pose> beams;
    for (std::size_t b = 0; b < x.size(); ++b) beams.push_back({x[b], y[b], heading[b]});
    return {beams, sensor.Scalar<double>("opening_rad"), sensor.Scalar<double>("max_range_m")};
  }
  RingScan Scan(std::size_t k) const {
    const auto range = sensor.Get<double>("range_m");
    const std::size_t beams = sensor.Get<double>("beam_x_m").size();
    return {sensor.Get<double>("time_s")[k], sensor.Get<double>("turret_rad")[k],
            range.subspan(k * beams, beams)};
  }
};

// A scan: where the robot was, and where its odometry with true headings has it.
struct Moment {
  Pose truth, odometry;
  double path_m;
};

struct Recorded {
  EdgeTrace trace;
  TraceFrame frame;
  std::size_t first, end;  // scans
};

struct Place {
  std::size_t scan;
  std::array<ImmediateTrace, 4> now;
};

struct Drive {
  std::vector<Moment> moments;
  std::vector<Recorded> traces;
  std::vector<Place> places;
};

std::vector<Moment> Moments(const Blob& log) {
  const Blob robot = log.Sub("robot/0/"), truth = log.Sub("truth/robot/0/poses/");
  const auto forward = robot.Get<double>("odometry/forward_m");
  const auto x = truth.Get<double>("x_m"), y = truth.Get<double>("y_m"),
             heading = truth.Get<double>("heading_rad");
  std::vector<Moment> moments;
  Pose odometry{x[0], y[0], heading[0]};
  double path_m = 0;
  for (std::size_t k = 0; k < forward.size(); ++k) {
    odometry.heading_rad = heading[k + 1];
    odometry = Compose(odometry, {forward[k], 0, 0});
    path_m += forward[k];
    moments.push_back({{x[k + 1], y[k + 1], heading[k + 1]}, odometry, path_m});
  }
  return moments;
}

Drive Replay(const Blob& log) {
  Drive drive;
  drive.moments = Moments(log);
  const Blob robot = log.Sub("robot/0/");
  const Ring sonar(robot, "sonar"), infrared(robot, "infrared");
  GridOptions options;
  options.align = false;
  options.half_cells = 25;
  LocalGrids grids(options, {sonar.ToRing(), infrared.ToRing()});
  TraceRecorder recorder(grids);
  bool runs = false;
  std::size_t first = 0;
  double last_m = 0;
  const auto finish = [&](std::size_t end) {
    if (drive.moments[end - 1].path_m - drive.moments[first].path_m > 1)
      drive.traces.push_back({recorder.trace(), recorder.frame(), first, end});
    runs = false;
  };
  for (std::size_t k = 0; k < drive.moments.size(); ++k) {
    const std::array scans{sonar.Scan(k), infrared.Scan(k)};
    grids.Update(drive.moments[k].odometry, scans);
    if (runs && recorder.Update(grids, scans[0].time_s) != TraceEnd::kNone) finish(k);
    const double off = std::remainder(drive.moments[k].truth.heading_rad, std::numbers::pi / 2);
    if (!runs && std::abs(off) < 0.25) {
      recorder.Begin(grids, scans[0].time_s);
      recorder.Update(grids, scans[0].time_s);
      first = k;
      runs = true;
    }
    if (drive.moments[k].path_m - last_m < 0.7) continue;
    last_m = drive.moments[k].path_m;
    drive.places.push_back(
        {k, {ImmediateRoom(grids), ImmediateRoom(grids), ImmediateRoom(grids), ImmediateRoom(grids)}});
    for (int q = 0; q < 4; ++q) MakeImmediate(grids, q, drive.places.back().now[static_cast<std::size_t>(q)]);
  }
  if (runs) finish(drive.moments.size());
  return drive;
}

// Where the truth puts a place on a trace, by the nearest moment of its recording, which `apart_m` tells of.
Position TruthOn(const Drive& drive, const Recorded& trace, std::size_t scan, double* apart_m) {
  const Pose& at = drive.moments[scan].truth;
  std::size_t best = trace.first;
  const auto off = [&](std::size_t k) {
    return std::hypot(drive.moments[k].truth.x_m - at.x_m, drive.moments[k].truth.y_m - at.y_m);
  };
  for (std::size_t k = trace.first; k < trace.end; ++k)
    if (off(k) < off(best)) best = k;
  *apart_m = off(best);
  const Moment& nearest = drive.moments[best];
  return trace.frame.At(
      {nearest.odometry.x_m + at.x_m - nearest.truth.x_m, nearest.odometry.y_m + at.y_m - nearest.truth.y_m},
      trace.trace.cell_m());
}

struct Tables {
  Loops along, across, wrong;
  Errors corrected, alone, together;
};

// Places that lie on two traces of which one follows the other around a corner.
void MatchPairs(const Drive& drive, double range_m, Rng& rng, Tables& tables) {
  const auto judge = [](Errors& errors, const Match& match, const Position& truth) {
    ++errors.tried;
    if (match.usable()) errors.Add(truth, match.z_m, match.u_m, match.sd_z_m, match.sd_u_m);
  };
  for (std::size_t t = 0; t + 1 < drive.traces.size(); ++t) {
    const Recorded &a = drive.traces[t], &b = drive.traces[t + 1];
    const int turned = (b.frame.quarter - a.frame.quarter + 4) % 4;
    if (turned % 2 == 0) continue;
    const int quarter = turned == 1 ? 1 : -1;
    for (const Place& place : drive.places) {
      const double path_m = drive.moments[place.scan].path_m;
      if (path_m > drive.moments[a.first].path_m - 6 && path_m < drive.moments[b.end - 1].path_m + 6)
        continue;
      double a_apart_m = 0, b_apart_m = 0;
      const Position on_a = TruthOn(drive, a, place.scan, &a_apart_m);
      const Position on_b = TruthOn(drive, b, place.scan, &b_apart_m);
      if (a_apart_m > 1 || b_apart_m > 1) continue;
      const double dz = rng.Uniform(-0.7, 0.7) * range_m, du = rng.Uniform(-0.7, 0.7) * range_m;
      const ImmediateTrace& now_a = place.now[static_cast<std::size_t>(a.frame.quarter)];
      const ImmediateTrace& now_b = place.now[static_cast<std::size_t>(b.frame.quarter)];
      const OnTrace first{a.trace, now_a, {on_a.z_m + dz, on_a.u_m + du}};
      const OnTrace second{b.trace, now_b, {on_b.z_m + quarter * du, on_b.u_m - quarter * dz}};
      judge(tables.alone, Correct(first, {range_m, range_m}, {}), on_a);
      judge(tables.together, CorrectPair(first, second, quarter, {range_m, range_m}, {}).first, on_a);
    }
  }
}

void MatchAll(const Drive& drive, double range_m, Rng& rng, Tables& tables) {
  for (const Place& place : drive.places)
    for (const Recorded& trace : drive.traces) {
      const double path_m = drive.moments[place.scan].path_m;
      if (path_m > drive.moments[trace.first].path_m - 6 && path_m < drive.moments[trace.end - 1].path_m + 6)
        continue;
      double apart_m = 0;
      const Position truth = TruthOn(drive, trace, place.scan, &apart_m);
      const ImmediateTrace& now = place.now[static_cast<std::size_t>(trace.frame.quarter)];
      const Position at{truth.z_m + rng.Uniform(-0.7, 0.7) * range_m,
                        truth.u_m + rng.Uniform(-0.7, 0.7) * range_m};
      const Position origin{at.z_m - now.robot.z_m, at.u_m - now.robot.u_m};
      const Position true_origin{truth.z_m - now.robot.z_m, truth.u_m - now.robot.u_m};
      const bool here = apart_m < 1, elsewhere = apart_m > 4;
      if (!here && !(elsewhere && rng.Uniform() < 0.05)) continue;
      if (elsewhere) {  // as if it were somewhere on that trace
        const double z = rng.Uniform(0, trace.trace.end_z() * trace.trace.cell_m());
        tables.wrong.Add(FindOn(trace.trace, now.trace, {z, rng.Uniform(-0.5, 0.5)}, {range_m, range_m}, {}),
                         nullptr);
        continue;
      }
      const double turned =
          drive.moments[place.scan].truth.heading_rad - drive.moments[trace.first].truth.heading_rad;
      Loops& loops = std::abs(std::cos(turned)) > 0.7 ? tables.along : tables.across;
      loops.Add(FindOn(trace.trace, now.trace, origin, {range_m, range_m}, {}), &true_origin);
      const Match match = Correct(trace.trace, now, at, {range_m, range_m}, {});
      ++tables.corrected.tried;
      if (match.usable()) tables.corrected.Add(truth, match.z_m, match.u_m, match.sd_z_m, match.sd_u_m);
    }
}

int Main(const std::vector<std::string>& args) {
  if (args.size() < 2) throw InputError("what is measured is RANGE_M LOG.h5 ...");
  Tables tables;
  for (std::size_t k = 1; k < args.size(); ++k) {
    const auto log = ReadBlobFile(args[k]);
    if (!log.ok()) throw InputError(log.status().message());
    Rng rng(k);
    const Drive drive = Replay(log.value().blob);
    MatchAll(drive, std::atof(args[0].c_str()), rng, tables);
    MatchPairs(drive, std::atof(args[0].c_str()), rng, tables);
  }
  tables.corrected.Print("corrected");
  tables.alone.Print("at corners, on one trace");
  tables.together.Print("at corners, on a pair");
  tables.along.Print("found, along or back");
  tables.across.Print("found, across");
  tables.wrong.Print("another place");
  return 0;
}

}  // namespace
}  // namespace cairn::local_map

int main(int argc, char** argv) {
  return cairn::BenchMain("trace_office", cairn::local_map::Main, argc, argv);
}
