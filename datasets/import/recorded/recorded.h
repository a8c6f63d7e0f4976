// `cairn import lego-robot` and `cairn import victoria-park`: folders of two single recordings, their files
// plain or gzipped (docs/datasets.md says where from). Landmarks have no identity in either, positions of the
// robot were measured without headings: the truth's heading is the course from position to position.
#pragma once

#include <string>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct RecordedImportOptions {
  std::string folder;
  bool skip_bad = false;  // skip bad lines and count them by reason, instead of stopping at the first
  NoiseParameters noise;  // neither recording states any
  bool scans = false;     // the laser's scans, instead of what their makers found in them
};

// Claus Brenner's LEGO robot among six poles: robot4_motors.txt (ticks), cylinders.txt (poles that a detector
// found in each laser scan, some of them none, in the scanner's frame), and as truth robot4_reference.txt and
// robot_arena_landmarks.txt. Rows of the first three belong together by their number: their clocks differ, so
// the motors' one counts for all, a repeated time as a millisecond later. A reading lies at its place seen
// from the middle of the axle.
ImportReport ImportLegoRobot(const RecordedImportOptions& options, Blob* log);

// Victoria Park, Sydney (J. Guivant, E. Nebot 2001): trees/time, speed, steering, lasersampling,
// ObservationDistance and ObservationAngle (.txt), and as truth GPS.txt, partial: trees hide the sky. Poses
// are of the middle of the rear axle, by the car's geometry. GPS keeps another clock, 20.967 s behind.
ImportReport ImportVictoriaPark(const RecordedImportOptions& options, Blob* log);

// Of positions in the order of time: the direction from the last one that is `least_m` away or more; before
// the first such move, that move's. All zero where nothing moves.
std::vector<double> Course(const std::vector<double>& x_m, const std::vector<double>& y_m, double least_m);

}  // namespace cairn::datasets
