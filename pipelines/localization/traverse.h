// One run of the experiment ([Thr98] section 5.2.4): a robot that sets out somewhere in a run of the samples
// and senses every so often on its way.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/localization/belief.h"
#include "pipelines/localization/options.h"
#include "pipelines/localization/source.h"
#include "schema/rng.h"

namespace cairn::localization {

// Where it senses: a sample of the run, and how the robot believes to have moved since the stop before (since
// the start, for the first).
struct Stop {
  std::size_t sample = 0;
  double travelled_m = 0.0;  // travelled since the start
  Position displacement;     // with odometry's error
  OwnMotion own;             // the same as it faced at the stop before; where the run has headings
};

struct Traverse {
  std::size_t run = 0;    // index into the source's runs
  std::size_t start = 0;  // sample from which it sets out
  std::vector<Stop> stops;
};

// The options' traverse number `number`, everything drawn from (seed, number): runs are taken in turn, the
// start is a position of the run from which `travelled_m` are left, each as likely as another by the way
// until there (from the beginning, where there is none). A stop is the first sample at which `every_m` more
// have been travelled. Displacements are those between the labels of the samples with an error of
// `odometry_ratio` of their length, turns those between their headings with an error of that share of them;
// or both are by the run's odometry, from the heading that its label has at the stop before. Throws
// InputError where a run is so short that it has no stop.
Traverse MakeTraverse(const Options& options, const Source& source, std::size_t number, std::uint64_t seed);

// How many there are: `traverses`, or as many as there are runs.
std::size_t TraverseCount(const Options& options, const Source& source);

// The belief at the start and after each stop.
struct Localized {
  // How much better the belief just before foretold what is sensed than one that knows nothing would have: of
  // each bit the log of the ratio of its probabilities, added up; and what that is on average where the
  // belief is right.
  struct Lead {
    double nats = 0.0, expected_nats = 0.0;
  };
  struct Step {
    Estimate estimate;
    Lead lead;
    std::vector<std::int32_t> position;  // those with a belief above kKeptShare of the largest, ascending
    std::vector<float> probability;      // of each, adding up to 1
  };
  std::vector<Step> steps;  // [stops + 1]
};
inline constexpr double kKeptShare = 1e-4;

// [Thr98] table 1. `map`: P(f_i = 1 | xi), [positions][features].
// Throws InputError that names run and sample where
// - the robot has left all positions of the map (only where options.lost is 0);
// - no position where it may be faces as it does;
// - what it senses is impossible wherever it may be (only where options.prior_count is 0).
Localized Localize(const Options& options, const Source& source, const BeliefSpace& space,
                   const std::vector<double>& map, double least_sd_m, const Traverse& traverse, Rng rng,
                   Progress& progress);

}  // namespace cairn::localization
