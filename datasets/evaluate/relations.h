// Trajectories against relations: relative poses that people checked by hand against matched scans, the
// benchmark of R. Kuemmerle, B. Steder, C. Dornhege, M. Ruhnke, G. Grisetti, C. Stachniss, A. Kleiner, On
// measuring the accuracy of SLAM algorithms, Autonomous Robots 27(4):387-407, 2009. No frame needs to be
// aligned, and an error made once counts once.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/evaluate/scores.h"
#include "datasets/evaluate/track.h"
#include "schema/blob.h"
#include "schema/geometry.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {

struct Relation {
  double from_s = 0, to_s = 0;
  Pose motion;  // the pose at `to_s` as seen from that at `from_s`
};

// Lines of 'time time x y z roll pitch yaw', plain or gzipped; z, roll and pitch are forgotten.
// Throws InputError "FILE:LINE: REASON: DETAIL": not a number, not finite, other numbers of values; or that
// there are none.
std::vector<Relation> ReadRelations(const std::string& path);

// Where a robot's controls alone lead from the origin; of rows of one time the last.
Track DeadReckoned(const kinds::Log::Odometry& odometry);

struct RelationScore {
  std::int64_t scored = 0, outside = 0;  // relations; those of a time before the first pose or after the last
  double translation_m = 0, rotation_deg = 0;          // mean errors of those that are scored
  double translation_rms_m = 0, rotation_rms_deg = 0;  // roots of the mean squared ones
};

// Poses are interpolated over all rows of the track, however far apart. `offset_s`: what the relations' clock
// says when the track's says 0.
// Throws InputError where no relation lies within the track's time.
RelationScore ScoreRelations(const Track& track, const std::vector<Relation>& relations, double offset_s);

// Where robot `robot` was: of a landmark_map its most likely poses, of a file with a table of poses those, of
// a grid_map the poses of its scans, of a log without such a table its odometry. An empty name is the only
// robot's.
// Throws InputError: no such robot, several and no name, nothing of all these.
Track ReadTrajectory(const Blob& blob, const std::string& robot);

Scores MakeScores(const RelationScore& score);

}  // namespace cairn::datasets
