// The schedule of iterations: from the State alone.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipelines/common/state_scalars.h"
#include "pipelines/landmark_map/state/options.h"
#include "pipelines/landmark_map/state/settings.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// What a round does.
enum class Phase : std::int32_t {
  kMap,            // E- and M-step
  kSummary,        // the last E-step, which also gives poses and associations
  kRefinedSummary  // the same under the map of the least squares (refine.h)
};

// Schedule::apart of such a log: where landmarks are seen at a distance and have no names, a robot that took
// a wrong place when it joined explains all that it sees by landmarks of its own and never leaves it.
std::int64_t IterationsApart(const Settings& settings);

// Where EM stands. Robots but the first start anywhere ([TBF98] section 8): they join when there is a map.
struct Schedule {
  Phase phase = Phase::kMap;
  std::int64_t iteration = 0;   // E-steps done
  double prefix = 1.0;          // fraction of the steps in use
  std::int64_t robots = 1;      // robots that take part
  std::int64_t settled = 0;     // iterations on all data of these robots
  double log_likelihood = 0.0;  // of the iteration before
  double growth = 2.0;          // factor on the prefix an iteration
  std::int64_t apart = 0;       // iterations after the others joined in which each looks at others' map alone
  bool placed_anew = false;     // a robot was, once all had settled: that is done once

  bool summarises() const { return phase != Phase::kMap; }
  bool is_refined() const { return phase == Phase::kRefinedSummary; }
  // Each robot but the first is found in the map that the others alone make.
  bool is_apart() const { return phase == Phase::kMap && robots > 1 && settled >= 1 && settled <= apart; }
  // The next one may be.
  bool comes_before_apart() const { return phase == Phase::kMap && robots > 1 && settled < apart; }
  // Where landmarks are seen at a distance and names do not say where robots are: once rounds before have
  // found a robot anywhere it starts near where the last one had it. All but the first are found anew while
  // they are apart, unless there are two, for the other one's map alone hardly changes; and in the map of all
  // that comes then.
  bool StartsNearby(std::size_t robot) const;
  void Store(State* state) const { PutScalars(*this, "", state); }
  // Throws InputError where it is none, or of more robots than there are: others made the State.
  static Schedule Load(const State& state, std::size_t all_robots = 1 << 30);
  static void Fields(const auto& field) {
    field("phase", &Schedule::phase);
    field("iteration", &Schedule::iteration);
    field("prefix", &Schedule::prefix);
    field("robots", &Schedule::robots);
    field("settled", &Schedule::settled);
    field("log_likelihood", &Schedule::log_likelihood);
    field("growth", &Schedule::growth);
    field("apart", &Schedule::apart);
    field("placed_anew", &Schedule::placed_anew);
  }
  // After an E-step that found `log_likelihood_now` for so many observations. EM has settled where it changed
  // by less than `tolerance` an observation: a share of the whole would depend on the unit of densities.
  Schedule Next(const Options& options, std::int64_t all_robots, double log_likelihood_now,
                double observations) const;
};

}  // namespace cairn::landmark_map
