// What Start decides from the log and the options, and the schedule of iterations: from the State alone.
#pragma once

#include <cstdint>

#include "pipelines/landmark_map/e_step.h"
#include "pipelines/landmark_map/false_landmarks.h"
#include "pipelines/landmark_map/m_step.h"
#include "pipelines/landmark_map/options.h"
#include "pipelines/landmark_map/steps.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// The resolved figures of a job.
struct Settings {
  MapRules map;
  MotionNoise noise;
  StepRules steps;
  Detection detection;
  ErrorShape shape = ErrorShape::kGaussian;
  double prune = 1e-3;
  bool keep_kernels = false;
  bool whole_tables = false;
  double box_m = 0.0;
  double growth_start = 1.0;
  double growth_factor = 2.0;
  int starts = 1;       // candidate starts
  double places = 1.0;  // cells in which a landmark may stand
  double memory_mb = 4096.0;

  EStepModel Model(const Perception* perception) const;
  Blob ToBlob() const;
  static Settings FromBlob(const Blob& blob);
};

// Distance between the drifts of neighbouring starts, in nominal standard deviations: half of the starts, or
// one more, spread evenly over two to either side.
double DriftStep(int starts);

// From the options, the log's nominal figures, and defaults where both are silent. Throws InputError.
Settings Resolve(const Options& options, const Blob& log);

// The same options for the search of several starts: on the default grid, where a finer one is asked for.
Options ForSearch(const Options& options, const Blob& log);

// Where EM stands. Robots but the first start anywhere ([TBF98] section 8): they join when there is a map.
struct Schedule {
  std::int64_t iteration = 0;   // E-steps done
  double prefix = 1.0;          // fraction of the steps in use
  std::int64_t robots = 1;      // robots that take part
  std::int64_t settled = 0;     // iterations on all data of these robots
  double log_likelihood = 0.0;  // of the iteration before
  bool summarise = false;       // the last E-step, which also gives poses and associations
  double growth = 2.0;          // factor on the prefix an iteration
  bool polished = false;        // the map is that of the least squares (polish.h)

  void Store(State* state) const;
  static Schedule Load(const State& state);
  // After an E-step that found `log_likelihood_now` for so many observations. EM has settled where it changed
  // by less than `tolerance` an observation: a share of the whole would depend on the unit of densities.
  Schedule Next(const Options& options, std::int64_t all_robots, double log_likelihood_now,
                double observations) const;
  // At most.
  std::int64_t RoundsLeft(const Options& options, std::int64_t all_robots) const;
};

}  // namespace cairn::landmark_map
