// What `cairn reproduce landmarks` runs: the logs and the job behind the figures of S. Thrun, W. Burgard, D.
// Fox, A Probabilistic Approach to Concurrent Mapping and Localization for Mobile Robots, Machine Learning
// 31, 1998, on simulated data.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn::datasets {

struct LandmarkStudy {
  // Logs, with truth where they are simulated drives: first, second and both robots of one world, `other`
  // (another world's), `back` (the first one's drive backwards), `motion_log` and `perception_log` (made by
  // hand); and `landmarks`, a landmark_map made by hand.
  std::map<std::string, Blob> inputs;
  proto::Job job;  // its inputs by these names
  // Of the first robot, numbers of observations from 1 on: the first of a landmark seen before, the first of
  // one seen before the way round the large cycle, all.
  int revisit = 0, closing = 0, observations = 0;
};

inline constexpr double kStraightM = 40.0;  // figure 1: a way, a right turn, a way
inline constexpr double kSeenAtM = 5.0;     // figure 2
inline constexpr double kBetweenM = 14.0;   // figure 2: of its two landmarks, on the x-axis round the origin

// Throws InputError where the seed's drive closes no large cycle.
LandmarkStudy MakeLandmarkStudy(std::uint64_t seed);

// "prefix_07", the stage that maps the first robot's data up to that observation.
std::string PrefixStage(int observations);

}  // namespace cairn::datasets
