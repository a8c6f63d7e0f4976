// Which pipelines a log asks for: a job made of what the log holds, for people to keep and change.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn::cli {

struct ChosenJob {
  proto::Job job;                    // its input `log` has no path yet
  std::vector<std::string> reasons;  // a sentence a choice, in the order of the stages
};

// Observations of landmarks: `landmark_map`. Range scans: `local_map`, which finds a path by what the robot
// sees, unless the log has poses of its own; then a grid of occupied and free cells by the best poses there
// are: those of landmarks, else the log's own, else those of `local_map`, which ties no two robots together:
// then each robot has a grid of its own, but of more robots than anybody looks at there is none.
// Throws InputError where the log has neither, or a robot without the odometry or poses that these need.
ChosenJob ChooseJob(const Blob& blob);

}  // namespace cairn::cli
