// What Start decides from the log and the options.
#pragma once

#include <string>

#include "pipelines/landmark_map/landmarks/false_landmarks.h"
#include "pipelines/landmark_map/model/e_step.h"
#include "pipelines/landmark_map/model/m_step.h"
#include "pipelines/landmark_map/model/sensing.h"
#include "pipelines/landmark_map/model/steps.h"
#include "pipelines/landmark_map/state/options.h"
#include "schema/blob.h"

namespace cairn::landmark_map {

// The resolved figures of a job.
struct Settings {
  MapRules map;
  MotionNoise noise;
  // What odometry's widths are before its data say anything, where EM may start from wider ones: as the log
  // states them, else those of small robots.
  double expected_walk_rad_per_sqrt_m = 0.012, expected_turn_ratio = 0.02;
  StepRules steps;
  Detection detection;
  ObservationNoise observation_noise;  // as stated; EM takes nothing for more exact than usual
  double in_image_m = 0.3;             // how far off an observation of an image is, as stated
  ErrorShape shape = ErrorShape::kGaussian;
  double prune = 1e-3;
  bool keep_kernels = false;
  bool whole_tables = false;
  double box_m = 0.0;
  double growth_start = 1.0;
  double growth_factor = 2.0;
  bool gauge_free = false;         // the first robot, too, starts anywhere once others have joined
  bool joins_by_geometry = false;  // some robot, for want of names, though others give some
  bool incremental = false;        // what is found is not looked at again
  int starts = 1;                  // candidate starts
  double alike = 0.99;             // maps that say the same of so many observations are one
  double places = 1.0;             // cells in which a landmark may stand
  double memory_mb = 4096.0;

  EStepModel Model(const Perception* perception) const;
  // Of a table that lies in memory.
  double MostCells() const { return 1e6 * memory_mb / sizeof(double); }
  Blob ToBlob() const;
  // Throws InputError where these are none that Resolve could give.
  static Settings FromBlob(const Blob& blob);
  // The same as others hand them on: they allow no more memory than the job does.
  static Settings In(const Blob& blob, const Options& options);

 private:
  void Check() const;
};

// Throws InputError that names both figures where `what` needs more than is allowed.
void RequireMemory(const std::string& what, double bytes, double memory_mb);

// Distance between the drifts of neighbouring starts, in nominal standard deviations: half of the starts, or
// one more, spread evenly over two to either side.
double DriftStep(int starts);

// How many candidate starts EM has, and for people why so many: as many as the options ask for; where they
// leave it open one of a log whose observations all name their landmark and under model=exact, else ten, or
// as many as should take ten minutes of one core and, of range-bearing observations, look at 20,000 of them,
// all by sizes; one where that is fewer than five.
struct StartChoice {
  int count = 1;
  std::string why;
};
StartChoice ChooseStarts(const Options& options, const Blob& log);

// From the options, the log's noise parameters, and defaults where both are silent.
// Throws InputError where
// - the log has no robots, or no observations of landmarks;
// - one of its noise parameters is not from 0 to 1000, or its confusion of types is no table of
// probabilities;
// - an option is out of what the log allows: model exact for ranges and bearings or for types, tables whole
//   without box_m;
// - the grid would need more than memory_mb.
Settings Resolve(const Options& options, const Blob& log);

// The same options for the search of several starts: on the default grid, or, where that is finer than a 90th
// of the first robot's extent, one up to two and a half times as coarse, if the map's is finer.
Options ForSearch(const Options& options, const Blob& log);

}  // namespace cairn::landmark_map
