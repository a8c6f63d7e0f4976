// What `cairn-reproduce landmarks` runs: the logs and the job behind the figures of [TBF98], on simulated
// data.
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
  // Of the first robot's observations, counted from 1: the one that closes the large cycle, and all.
  int closing = 0, observations = 0;
  // Of the drive backwards: the first of a landmark seen before, and how far it is round that cycle; 0 where
  // it is not a small one.
  int revisit = 0;
  double revisit_m = 0;
};

inline constexpr double kStraightM = 40.0;  // figure 1: a way, a right turn, a way
inline constexpr double kSeenAtM = 5.0;     // figure 2
inline constexpr double kBetweenM = 14.0;   // figure 2: of its two landmarks, on the x-axis round the origin

// Throws InputError where the seed's drive closes no large cycle.
LandmarkStudy MakeLandmarkStudy(std::uint64_t seed);

// Plain EM, as the paper ran it, after its first iterations: "iterations_2", up to this many.
inline constexpr int kShownIterations = 6;
std::string IterationsStage(int iterations);

// "prefix_07", the stage in which plain EM maps the first robot's data up to that observation.
std::string PrefixStage(int observations);

}  // namespace cairn::datasets
