// How often forward_map's search ends in the best of all maps of worlds so small that all can be tried, by
// the moves that it has.
//   tiny_worlds [WORLDS [FIRST_SEED]]        of each kind; 100, from 101 on
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "pipelines/forward_map/search.h"
#include "pipelines/forward_map/testing.h"

namespace cairn::forward_map {
namespace {

constexpr double kEqual = 1e-9;
enum class Method { kFlips, kSwaps, kPairs, kAll, kAnnealed };
constexpr Method kMethods[] = {Method::kFlips, Method::kSwaps, Method::kPairs, Method::kAll,
                               Method::kAnnealed};

// From `start`, with sigma `factor` times as large.
Patch Searched(const TinyWorld& world, Patch start, double factor, const Moves& moves) {
  SensorModel model = world.model;
  model.sigma_m *= factor;
  FlipGains gains = GainsOf(world.data, start.Inside(), model);
  MapSearch(&gains, start, {}).Run(moves, [] {});
  for (std::int32_t cell = 0; cell < start.cells(); ++cell)
    start.rimmed[start.Rimmed(cell)] = gains.occupied()[static_cast<std::size_t>(cell)];
  return start;
}

double EndOf(const TinyWorld& world, Method method) {
  const Patch empty = Patch::Empty(world.columns, world.rows);
  const Moves moves{.swaps = method == Method::kSwaps || method == Method::kAll,
                    .pairs = method == Method::kPairs || method == Method::kAll};
  const auto value = [&](const Patch& patch) {
    return LogLikelihood(world.data, patch.Inside(), world.model);
  };
  const double direct = value(Searched(world, empty, 1, moves));
  if (method != Method::kAnnealed) return direct;
  Patch wide = empty;
  for (const double factor : {4.0, 2.0, 1.0}) wide = Searched(world, wide, factor, moves);
  return std::max(direct, value(wide));
}

TinyWorld World(double opening_rad, double p_hit, std::uint64_t seed) {
  TinyWorld world{.columns = 4,
                  .rows = seed % 10 == 0 ? 4 : 3,
                  .readings = static_cast<int>(6 + seed % 20),
                  .occupied_share = seed % 2 == 0 ? 0.25 : 0.5,
                  .opening_rad = opening_rad,
                  .seed = seed};
  world.model.p_hit = p_hit;
  return world.Make();
}

int Main(int argc, char** argv) {
  const int worlds = argc > 1 ? std::atoi(argv[1]) : 100;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 101;
  std::printf("opening  p_hit  flips  swaps  pairs  swaps+pairs  annealed    of %d\n", worlds);
  for (const double opening_rad : {0.5, 1.0, 1.5}) {
    for (const double p_hit : {0.3, 0.7, 0.95}) {
      int optimal[std::size(kMethods)] = {};
      for (int w = 0; w < worlds; ++w) {
        const TinyWorld world = World(opening_rad, p_hit, first + static_cast<std::uint64_t>(w));
        const double best = BestOfAllMaps(world);
        for (std::size_t i = 0; i < std::size(kMethods); ++i)
          optimal[i] += EndOf(world, kMethods[i]) > best - kEqual ? 1 : 0;
      }
      std::printf("%7.1f  %5.2f  %5d  %5d  %5d  %11d  %8d\n", opening_rad, p_hit, optimal[0], optimal[1],
                  optimal[2], optimal[3], optimal[4]);
    }
  }
  return 0;
}

}  // namespace
}  // namespace cairn::forward_map

int main(int argc, char** argv) { return cairn::forward_map::Main(argc, argv); }
