// How fast the local grids of local_map are, in one thread:
//   local_rate [SCANS]
// all four sensory resources (hits, occupancy grid, wall orientation, edge grid) updated for one scan of 24
// sonars, 31 x 31 cells of 0.15 m, in furnished rooms; and what it takes to move the occupancy grid on by one
// cell or by seven and to take in a hit, for grids of 15 x 15 to 255 x 255 cells.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "pipelines/local_map/grids/local_grids.h"
#include "pipelines/local_map/testing/room.h"
#include "tests/bench/bench_main.h"

namespace cairn::local_map {
namespace {

using Clock = std::chrono::steady_clock;

double MicrosecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

// What a robot met on its way, so that nothing but the grids is measured.
struct Recorded {
  double time_s;
  Pose odometry;
  double turret_rad;
  std::vector<double> range_m;
};

std::vector<Recorded> Record(int scans, std::uint64_t seed) {
  const TestRoom room(seed);
  TestDrive drive(room, seed);
  std::vector<Recorded> all;
  for (int k = 0; k < scans; ++k) {
    const RingScan scan = drive.Next();
    all.push_back(
        {scan.time_s, drive.odometry(), scan.turret_rad, {scan.range_m.begin(), scan.range_m.end()}});
  }
  return all;
}

void PrintQuantiles(const char* what, std::vector<double> us) {
  std::sort(us.begin(), us.end());
  const auto at = [&](double share) {
    return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
  };
  std::printf("%-44s median %7.2f us, 90%% %7.2f, 99%% %7.2f\n", what, at(0.5), at(0.9), at(0.99));
}

void MeasureScans(int scans) {
  std::vector<double> us;
  double edges = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    LocalGrids grids({}, {SensorRing(RingBeams(), kTestOpeningRad, 6)});
    for (const Recorded& r : Record(scans, seed)) {
      const RingScan scan{r.time_s, r.turret_rad, r.range_m};
      const auto begin = Clock::now();
      grids.Update(r.odometry, std::span(&scan, 1));
      us.push_back(MicrosecondsSince(begin));
      edges += static_cast<double>(grids.current_edges().size());
    }
  }
  PrintQuantiles("a scan of 24 sonars, 31 x 31 cells", us);
  std::printf("%-44s %.2f\n", "edges a scan", edges / static_cast<double>(us.size()));
}

// The least of some turns, nanoseconds a move.
double MoveNs(int half, double step_m) {
  constexpr int kMoves = 100000;
  OccupancyGrid grid(0.15, half, 0.95, 0.08);
  double least = 1e9;
  for (int turn = 0; turn < 5; ++turn) {
    grid.MoveTo(0, 0);
    grid.NextScan();
    double x = 0;
    const auto begin = Clock::now();
    for (int k = 0; k < kMoves; ++k) {
      x += step_m;
      grid.MoveTo(x, x);
      if (!grid.Hit({x + 0.3, x})) throw InputError("a hit beside the robot is not in the grid");
    }
    least = std::min(least, 1e3 * MicrosecondsSince(begin) / kMoves);
  }
  return least;
}

int Main(const std::vector<std::string>& args) {
  const int scans = args.empty() ? 1000 : std::atoi(args[0].c_str());
  if (args.size() > 1 || scans < 1) throw InputError("what is measured is [SCANS], at least one");
  MeasureScans(scans);
  for (const int half : {7, 15, 31, 63, 127}) {
    const int edge = 2 * half + 1;
    std::printf("%-14s %3d x %3d %26s %.1f ns; by 7 cells %.1f ns\n", "moving a grid of", edge, edge,
                "and one hit: by one cell", MoveNs(half, 0.15), MoveNs(half, 0.15 * 7));
  }
  return 0;
}

}  // namespace
}  // namespace cairn::local_map

int main(int argc, char** argv) { return cairn::BenchMain("local_rate", cairn::local_map::Main, argc, argv); }
