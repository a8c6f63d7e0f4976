// The pictures of the report, as inline SVG of a width in pixels.
#pragma once

#include <string>
#include <vector>

#include "datasets/report/scene.h"

namespace cairn::datasets::report {

// The map: paths, landmarks with their 95% regions, walls, and truth where the scene has it. Names are where
// they cover neither each other nor a landmark.
std::string MapPicture(const Scene& scene, double width);

// Dead reckoning and the corrected paths side by side (on a narrow page one above the other) at one scale;
// empty where the scene has no odometry.
std::string BeforeAfterPicture(const Scene& scene, double width);

// P(landmark) of each cell; empty where the scene has no grid.
std::string GridPicture(const Scene& scene, double width);

// One iteration of the expectation maximisation.
struct Iteration {
  double log_likelihood = 0;
  double prefix = 1;        // fraction of the data that it used
  std::int64_t robots = 1;  // that took part
};
// Log-likelihood by iteration, from the second on: the first had no map, its figure is of nothing. A line
// joins those of the same data; what is not of all data is hollow. Empty without a finite value.
std::string LikelihoodPicture(const std::vector<Iteration>& iterations, double width);

struct RoundTime {
  std::string note;
  double seconds = 0;          // wall time
  double compute_seconds = 0;  // of all its tasks, added up
  std::int64_t tasks = 0;
  std::int64_t rounds = 1;  // one after the other, that this is of
};
// A bar for each, as high as a round took, as wide as there are rounds; empty without any.
std::string RoundsPicture(const std::vector<RoundTime>& rounds, double width);

}  // namespace cairn::datasets::report
