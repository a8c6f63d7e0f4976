// A map to start from: an earlier result, brought onto this job's grid and landmark names.
#pragma once

#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/model/m_step.h"
#include "pipelines/landmark_map/state/schedule.h"

namespace cairn::landmark_map {

struct GivenMap {
  LayeredGrid map;  // a layer a type of this log, empty where the map has none of it
  std::vector<Landmark> landmarks;
};

// `map`: a landmark_map (schema/FORMAT.md) in the frame of this job. Types go by name; what the log cannot
// name is left out. Another resolution or another origin: each cell's probability is shared out by area among
// the cells that it covers, at most one in any, so that a landmark keeps its mass.
// Throws InputError where
// - it is no landmark_map, or holds what is no probability;
// - its types of landmarks are not the log's, or it holds none of the landmarks that the log can name;
// - at this resolution it would need more than memory_mb;
// - it lies outside box_m.
GivenMap ReadGivenMap(const Blob& map, const Blob& log, const Settings& settings);

// Throws InputError where a robot that starts at the origin can see nothing of the map, however its odometry
// errs: the map is of another place or in another frame.
void CheckReach(const LayeredGrid& map, const RobotSteps& steps, const Settings& settings);

// Throws InputError where an E-step under the map found the data no more likely than if every observation
// that the map could explain were a false one.
void CheckLikelihood(double log_likelihood, const Perception& perception,
                     const std::vector<RobotSteps>& robots);

}  // namespace cairn::landmark_map
