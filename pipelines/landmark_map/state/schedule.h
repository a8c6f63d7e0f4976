// The schedule of iterations: from the State alone.
#pragma once

#include <cstdint>

#include "pipelines/common/state_scalars.h"
#include "pipelines/landmark_map/state/options.h"
#include "pipelines/landmark_map/state/settings.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// Where EM stands. Robots but the first start anywhere ([TBF98] section 8): they join when there is a map.
struct Schedule {
  std::int64_t iteration = 0;   // E-steps done
  double prefix = 1.0;          // fraction of the steps in use
  std::int64_t robots = 1;      // robots that take part
  std::int64_t settled = 0;     // iterations on all data of these robots
  double log_likelihood = 0.0;  // of the iteration before
  bool summarise = false;       // the last E-step, which also gives poses and associations
  double growth = 2.0;          // factor on the prefix an iteration
  bool refined = false;         // the map is that of the least squares (refine.h)

  void Store(State* state) const { PutScalars(*this, "", state); }
  static Schedule Load(const State& state) { return ScalarsIn<Schedule>(state); }
  static void Fields(const auto& field) {
    field("iteration", &Schedule::iteration);
    field("prefix", &Schedule::prefix);
    field("robots", &Schedule::robots);
    field("settled", &Schedule::settled);
    field("log_likelihood", &Schedule::log_likelihood);
    field("summarise", &Schedule::summarise);
    field("growth", &Schedule::growth);
    field("refined", &Schedule::refined);
  }
  // After an E-step that found `log_likelihood_now` for so many observations. EM has settled where it changed
  // by less than `tolerance` an observation: a share of the whole would depend on the unit of densities.
  Schedule Next(const Options& options, std::int64_t all_robots, double log_likelihood_now,
                double observations) const;
};

}  // namespace cairn::landmark_map
