// How well positions are corrected by traces, and traces found on traces: errors over many corridors.
//   trace_accuracy [FIRST_SEED [SEEDS]]
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "pipelines/local_map/traces/find_on.h"
#include "tests/bench/trace_world.h"
#include "tests/studies/trace_errors.h"

namespace cairn::local_map {
namespace {

constexpr double kLengthM = 16;
constexpr double kRangeM = 0.6;  // of a correction
constexpr double kFindM = 4;     // of a loop, along; 1 m across
constexpr int kWindow = 40;      // features, of 0.15 m

struct Worlds {
  Pass recorded, again, moved, back, elsewhere;
};

Worlds MakeWorlds(std::uint64_t seed) {
  Walls walls = Building(seed, kLengthM), moved = walls, other = Building(seed + 5000, kLengthM);
  AddFurniture(walls, seed, 0, kLengthM);
  AddFurniture(moved, seed, 1, kLengthM);
  AddFurniture(other, seed + 5000, 0, kLengthM);
  Rng rng(seed, 9);
  const auto aside = [&] { return rng.Uniform(-0.25, 0.25); };
  return {DriveAlong(walls, kLengthM, aside(), false, 10 * seed),
          DriveAlong(walls, kLengthM, aside(), false, 10 * seed + 1),
          DriveAlong(moved, kLengthM, aside(), false, 10 * seed + 2),
          DriveAlong(walls, kLengthM, aside(), true, 10 * seed + 3),
          DriveAlong(other, kLengthM, aside(), false, 10 * seed + 4)};
}

// Positions that are off by up to 0.4 m both ways, corrected on `recorded`.
void Track(const Pass& recorded, const Pass& now, double range_m, const MatchOptions& options, Rng& rng,
           Errors& errors) {
  for (std::size_t k = 10; k < now.now.size(); k += 5) {
    const Position truth = TruthIn(recorded, now.true_x_m[k], now.true_y_m[k]);
    const Position at{truth.z_m + rng.Uniform(-0.4, 0.4), truth.u_m + rng.Uniform(-0.4, 0.4)};
    const Match match = Correct(recorded.trace, now.now[k], at, {range_m, range_m}, options);
    ++errors.tried;
    if (match.usable()) errors.Add(truth, match.z_m, match.u_m, match.sd_z_m, match.sd_u_m);
  }
}

// The same by correlation of whole grids, which says nothing of how sure it is.
void TrackByGrids(const Pass& recorded, const Pass& now, Rng& rng, Errors& errors) {
  for (std::size_t k = 10; k < now.now.size(); k += 5) {
    const Position truth = TruthIn(recorded, now.true_x_m[k], now.true_y_m[k]);
    const Position at{truth.z_m + rng.Uniform(-0.4, 0.4), truth.u_m + rng.Uniform(-0.4, 0.4)};
    const Position found =
        CorrelateGrids(recorded.map, now.grids_now[k], now.now[k].robot, at, {kRangeM, kRangeM});
    ++errors.tried;
    errors.Add(truth, found.z_m, found.u_m, 1, 1);
  }
}

// Where the second pass's origin lies in the first's trace, by the truth in the middle of the window's way.
Position OriginIn(const Pass& recorded, const Pass& other, bool reversed, int z, double cell_m) {
  std::size_t best = 0;
  const double at_m = (reversed ? -1 : 1) * z * cell_m;
  for (std::size_t k = 1; k < other.in_trace.size(); ++k)
    if (std::abs(other.in_trace[k].z_m - at_m) < std::abs(other.in_trace[best].z_m - at_m)) best = k;
  const Position truth = TruthIn(recorded, other.true_x_m[best], other.true_y_m[best]);
  const double sign = reversed ? -1 : 1;
  return {truth.z_m - sign * other.in_trace[best].z_m, truth.u_m - sign * other.in_trace[best].u_m};
}

// Windows of `features` of the other pass's trace, sought with metres of error.
void LoopAll(const Pass& recorded, const Pass& other, bool reversed, bool same, int features,
             const FindOptions& options, Rng& rng, Loops& loops) {
  const EdgeTrace trace = reversed ? Reversed(other.trace) : other.trace;
  for (int z = trace.first_z(); z + features <= trace.end_z(); z += features / 2) {
    const Position origin = OriginIn(recorded, other, reversed, z + features / 2, trace.cell_m());
    const Position at{origin.z_m + rng.Uniform(-3, 3), origin.u_m + rng.Uniform(-0.7, 0.7)};
    loops.Add(FindOn(recorded.trace, Part(trace, z, z + features), at, {kFindM, 1}, options),
              same ? &origin : nullptr);
  }
}

void Main(std::uint64_t first, std::uint64_t seeds) {
  MatchOptions options;
  Errors same[3], moved[3], grids_same, grids_moved;
  const FindOptions find;
  Loops again, back, rearranged, elsewhere;
  const char* names[] = {"average", "trimmed", "best side"};
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const Worlds worlds = MakeWorlds(seed);
    for (int scheme = 0; scheme < 3; ++scheme) {
      options.score.scheme = static_cast<Scheme>(scheme);
      Rng rng(seed, 20);
      Track(worlds.recorded, worlds.again, kRangeM, options, rng, same[scheme]);
      Track(worlds.recorded, worlds.moved, kRangeM, options, rng, moved[scheme]);
    }
    Rng first_rng(seed, 20);
    TrackByGrids(worlds.recorded, worlds.again, first_rng, grids_same);
    TrackByGrids(worlds.recorded, worlds.moved, first_rng, grids_moved);
    Rng rng(seed, 21);
    LoopAll(worlds.recorded, worlds.again, false, true, kWindow, find, rng, again);
    LoopAll(worlds.recorded, worlds.moved, false, true, kWindow, find, rng, rearranged);
    LoopAll(worlds.recorded, worlds.back, true, true, kWindow, find, rng, back);
    LoopAll(worlds.recorded, worlds.elsewhere, false, false, kWindow, find, rng, elsewhere);
  }
  for (int scheme = 0; scheme < 3; ++scheme) {
    same[scheme].Print((std::string("same, ") + names[scheme]).c_str());
    moved[scheme].Print((std::string("moved, ") + names[scheme]).c_str());
  }
  grids_same.Print("same, whole grids");
  grids_moved.Print("moved, whole grids");
  again.Print("loop, same way");
  rearranged.Print("loop, furniture moved");
  back.Print("loop, driven back");
  elsewhere.Print("another corridor");
}

}  // namespace
}  // namespace cairn::local_map

int main(int argc, char** argv) {
  const auto number = [&](int k, const char* standard) {
    return std::strtoull(argc > k ? argv[k] : standard, nullptr, 10);
  };
  cairn::local_map::Main(number(1, "0"), number(2, "10"));
}
