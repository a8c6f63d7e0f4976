// Tiny worlds whose maps can all be enumerated, and larger ones with known maps, for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "pipelines/common/range_scans.h"
#include "pipelines/common/testing_room.h"
#include "pipelines/forward_map/flip_gains.h"
#include "pipelines/forward_map/forward_model.h"
#include "pipelines/forward_map/state.h"
#include "schema/rng.h"

namespace cairn::forward_map {

// A reading and the cells of its beam, in order of distance.
struct BeamReading {
  double z_m;
  std::vector<Crossing> beam;
};

// sum_i log p(z_i | m) by forward_model.h.
inline double LogLikelihood(const std::vector<BeamReading>& readings,
                            const std::vector<std::uint8_t>& occupied, const SensorModel& model) {
  double sum = 0;
  for (const BeamReading& reading : readings) {
    std::vector<double> obstacles;
    for (const Crossing& crossing : reading.beam) {
      if (crossing.cell == kElsewhere || occupied[static_cast<std::size_t>(crossing.cell)] != 0)
        obstacles.push_back(crossing.distance_m);
    }
    sum += std::log(Density(reading.z_m, obstacles, model));
  }
  return sum;
}

inline FlipGains GainsOf(const std::vector<BeamReading>& readings, const std::vector<std::uint8_t>& occupied,
                         const SensorModel& model) {
  FlipGains gains(static_cast<std::int32_t>(occupied.size()), {model});
  for (const BeamReading& reading : readings) gains.Add(reading.z_m, 0, reading.beam);
  gains.Start(occupied);
  return gains;
}

// `columns` x `rows` cells of 1 m, some of them occupied, and readings by cones and rays from all around and
// from within, drawn by the model itself.
struct TinyWorld {
  std::int32_t columns = 4, rows = 4;
  int readings = 24;
  double occupied_share = 0.25;
  double opening_rad = 0.5;  // of every other beam; the others are rays
  SensorModel model{.p_hit = 0.7, .p_rand = 0.05, .sigma_m = 0.3, .no_echo_m = 0.3, .z_max_m = 8};
  std::uint64_t seed = 1;

  std::vector<std::uint8_t> truth = {};
  std::vector<BeamReading> data = {};

  TinyWorld& Make() {
    Rng rng(seed, 77);
    truth.clear();
    data.clear();
    for (std::int32_t cell = 0; cell < columns * rows; ++cell)
      truth.push_back(rng.Uniform() < occupied_share ? 1 : 0);
    for (int i = 0; i < readings; ++i) {
      BeamReading reading{0, BeamFrom(rng, i % 2 == 0 ? opening_rad : 0)};
      reading.z_m = Draw(rng, reading.beam);
      data.push_back(reading);
    }
    return *this;
  }

 private:
  std::vector<Crossing> BeamFrom(Rng& rng, double opening_rad_of_beam) const {
    // From a circle around the world, towards a place in it.
    const double turn = rng.Uniform(0, 2 * M_PI), away = rng.Uniform(1.5, 4);
    const double x = columns / 2.0 + away * std::cos(turn), y = rows / 2.0 + away * std::sin(turn);
    const double heading = std::atan2(rng.Uniform(0, rows) - y, rng.Uniform(0, columns) - x);
    std::vector<Crossing> beam;
    for (std::int32_t cell = 0; cell < columns * rows; ++cell) {
      const std::int32_t row = cell / columns;
      const double dx = cell % columns + 0.5 - x, dy = row + 0.5 - y;
      const double along = dx * std::cos(heading) + dy * std::sin(heading);
      const double across = std::abs(dy * std::cos(heading) - dx * std::sin(heading));
      const double half = std::max(0.5, along * std::tan(opening_rad_of_beam / 2));
      if (along > 0 && across < half) beam.push_back({cell, std::hypot(dx, dy)});
    }
    std::ranges::stable_sort(beam, {}, &Crossing::distance_m);
    return beam;
  }

  double Draw(Rng& rng, const std::vector<Crossing>& beam) const {
    if (rng.Uniform() < model.p_rand) return rng.Uniform(0, model.z_max_m);
    if (model.p_lost > 0 && rng.Uniform() < model.p_lost) return model.z_max_m;
    for (const Crossing& crossing : beam) {
      if (truth[static_cast<std::size_t>(crossing.cell)] != 0 && rng.Uniform() < model.p_hit)
        return std::max(0.0, crossing.distance_m + model.sigma_m * rng.Normal());
    }
    return model.z_max_m;
  }
};

// The log likelihood of the best of all maps of so small a world.
inline double BestOfAllMaps(const TinyWorld& world) {
  double best = -std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> map(world.truth.size());
  for (std::uint32_t number = 0; number < 1U << map.size(); ++number) {
    for (std::size_t cell = 0; cell < map.size(); ++cell) map[cell] = (number >> cell) & 1U;
    best = std::max(best, LogLikelihood(world.data, map, world.model));
  }
  return best;
}

inline std::vector<RangeScans> SensorsOf(const Room& room) {
  return ReadRangeScans(room.Log(), nullptr, {}).sensors;
}

inline MapState EmptyMapOf(const Room& room, double cell_m) {
  GridOptions options;
  options.cell_m = cell_m;
  MapState map{GridOf(ReadRangeScans(room.Log(), nullptr, options), options, 64), {}, {}};
  map.occupied.resize(static_cast<std::size_t>(map.box.cells()));
  map.models = {{.sigma_m = cell_m / 2, .no_echo_m = cell_m / 2, .z_max_m = room.max_range_m}};
  return map;
}

}  // namespace cairn::forward_map
