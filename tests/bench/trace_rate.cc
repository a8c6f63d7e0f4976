// How long it takes to build an immediate trace and to match it against a recorded one, in one thread, and to
// do the same by correlation of whole grids: 31 x 31 cells of 0.15 m, a range of 0.6 m both ways.
//   trace_rate [CORRIDORS]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "pipelines/local_map/traces/find_on.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/trace_world.h"

namespace cairn::local_map {
namespace {

using Clock = std::chrono::steady_clock;

struct Times {
  std::vector<double> us;

  template <class Work>
  void Measure(const Work& work) {
    const auto begin = Clock::now();
    work();
    us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
  }
  void Print(const char* what) {
    std::sort(us.begin(), us.end());
    const auto at = [&](double share) {
      return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
    };
    std::printf("%-52s median %8.1f us, 90%% %8.1f, 99%% %8.1f\n", what, at(0.5), at(0.9), at(0.99));
  }
};

int Main(const std::vector<std::string>& args) {
  constexpr double kLengthM = 16;
  const int corridors = args.empty() ? 10 : std::atoi(args[0].c_str());
  if (args.size() > 1 || corridors < 1) throw InputError("what is measured is [CORRIDORS], at least one");
  Times build, match, build_grid, correlate, find;
  int usable = 0;
  for (int c = 0; c < corridors; ++c) {
    const auto seed = static_cast<std::uint64_t>(c);
    Walls walls = Building(seed, kLengthM);
    ImmediateTrace now;
    AddFurniture(walls, seed, 0, kLengthM);
    const Pass recorded = DriveAlong(walls, kLengthM, 0, false, 2 * seed);
    const Pass again =
        DriveAlong(walls, kLengthM, 0.1, false, 2 * seed + 1,
                   [&](const LocalGrids& grids, const TraceRecorder& recorder) {
                     if (now.trace.features().empty()) now = ImmediateRoom(grids);
                     build.Measure([&] { MakeImmediate(grids, recorder.frame().quarter, now); });
                     build_grid.Measure([&] { MapOfNow(grids, recorder.frame().quarter); });
                   });
    for (std::size_t k = 0; k < again.now.size(); ++k) {
      const Position at{again.in_trace[k].z_m + 0.2, again.in_trace[k].u_m - 0.1};
      Match found;
      match.Measure([&] { found = Correct(recorded.trace, again.now[k], at, {0.6, 0.6}, {}); });
      usable += found.usable() ? 1 : 0;
      Position by_grids;
      correlate.Measure([&] {
        by_grids = CorrelateGrids(recorded.map, again.grids_now[k], again.now[k].robot, at, {0.6, 0.6});
      });
      usable += std::isnan(by_grids.z_m) ? 1000 : 0;
    }
    find.Measure(
        [&] { usable += static_cast<int>(FindOn(recorded.trace, again.trace, {}, {4, 1}, {}).size()); });
  }
  build.Print("immediate trace: built");
  match.Print("immediate trace: matched");
  build_grid.Print("whole grid: copied");
  correlate.Print("whole grid: correlated");
  find.Print("whole trace found on a trace, 4 m by 1 m");
  std::printf("%d matches and candidates\n", usable);
  return 0;
}

}  // namespace
}  // namespace cairn::local_map

int main(int argc, char** argv) { return cairn::BenchMain("trace_rate", cairn::local_map::Main, argc, argv); }
