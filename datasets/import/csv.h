// `cairn import csv`: people's own logs. Files are plain or gzipped, with a header; columns stand in any
// order, and others beside them are left alone; csv_reader.h says how a file may separate them and in which
// units. Robots and landmarks are called by any name; `robot` may be left out in all files of one robot.
// Times are of any clock, in order for each robot.
//
//   odometry            time_s,robot,turn_rad,forward_m    at the end of each control; first the turn, then
//   the way; or, where that is said, an arc
//                    or time_s,robot,v_mps,omega_radps     holds until the robot's next row
//                    or time_s,robot,x_m,y_m,heading_rad   dead reckoning: where the wheels say that it is
//   observations        time_s,robot,landmark,range_m,bearing_rad
//                         landmark empty: identity unknown; range and bearing empty: at the robot (a contact
//                         detection: the paper's button press)
//   truth_poses         time_s,robot,x_m,y_m,heading_rad
//   truth_landmarks     landmark,x_m,y_m
//   truth_associations  time_s,robot,landmark              for the observations of that robot and time, in
//   their order;
//                         landmark empty: a false one. Observations without a row are false too
#pragma once

#include <map>
#include <string>

#include "datasets/import/log_rows.h"
#include "datasets/import/repeated_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct CsvImportOptions {
  std::string odometry;      // the only file that is needed; an empty name: no such file
  std::string observations;  // without: the import warns
  std::string truth_poses;
  std::string truth_landmarks;     // without associations, truth is by the observations' own names
  std::string truth_associations;  // needs truth_landmarks
  bool skip_bad = false;  // skip bad lines and count them by reason, instead of stopping at the first
  NoiseParameters noise;  // max_range_m and field_of_view_rad also refuse what lies beyond
  // Of each robot's sensor where it sits (but for contact detections), and by how much its times are too
  // late; under the empty name those of the robots that are not named.
  std::map<std::string, Pose> mounts;
  std::map<std::string, double> late_s;
  RepeatedSteps repeated_steps = RepeatedSteps::kDetect;
  bool steps_are_arcs = false;  // rows turn_rad,forward_m are of a robot that turns while it goes
};

// Writes a `log` (schema/FORMAT.md). Robots are in the order in which odometry names them, landmarks by name
// (numbers by value). Bad are: not a number, not finite, wrong number of columns, time runs backwards,
// unknown robot (none that odometry names), unknown landmark (none that truth_landmarks names, of an
// association; of observations where that is so of all), before the first control or after the last (a robot
// that stood still there needs a row that says so), negative range, range 0, beyond the sensor's maximum,
// outside its field of view, range or bearing alone, a landmark or a robot whose name means unknown
// (name_index.h), no such observation (associations). Rows that are the same as an earlier one in every
// column are left out and counted: of observations (unless there are associations), true poses and odometry,
// of steps where they are copies (repeated_rows.h). Throws InputError "FILE:LINE:
// REASON: DETAIL"; of a file of odometry, observations or true poses of which more than half of the rows were
// skipped, too.
ImportReport ImportCsv(const CsvImportOptions& options, Blob* log);

}  // namespace cairn::datasets
