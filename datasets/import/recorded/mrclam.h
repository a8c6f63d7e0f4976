// `cairn import mrclam`: a folder of the UTIAS Multi-Robot Cooperative Localization and Mapping Dataset (K.
// Y. K. Leung, Y. Halpern, T. D. Barfoot, H. H. T. Liu, IJRR 30(8):969-974, 2011), its files plain or
// gzipped:
//
//   RobotN_Odometry.dat     time, forward velocity, angular velocity
//   RobotN_Measurement.dat  time, barcode, range, bearing
//   Barcodes.dat            subject, barcode: differs between the datasets, so it is always read
//   Landmark_Groundtruth.dat, RobotN_Groundtruth.dat                   where there, they become `truth/`
//
// The robots are those that have any file of theirs; each then needs the first two.
#pragma once

#include <string>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct MrclamImportOptions {
  std::string folder;
  bool skip_bad = false;  // skip bad lines and count them by reason, instead of stopping at the first
  bool withhold_identities = false;  // every `landmark` is -1, `landmarks` is empty; the truth still has them
  NoiseParameters noise;             // replaces figures of MrclamNoise()
  bool robots_as_clutter = false;    // robots that are seen become observations of no landmark, not of robots
};

// What the measurements themselves show of the camera, rounded: it looks ahead over 70 degrees and sees to 10
// m. The dataset gives no noise parameters, of odometry or camera, and the importer makes none up.
NoiseParameters MrclamNoise();

// Writes a `log` (schema/FORMAT.md). Robots and landmarks are called by their subject numbers. Each velocity
// holds until the next one (VelocityIntegrator); repeated time stamps add nothing. Measurements and true
// poses that are the same as an earlier one are left out and counted. Measurements of other robots become
// `robot/N/robot_observations`, or, with robots_as_clutter, observations whose `landmark` is -1, in the truth
// too: what a detector that cannot tell a robot from a landmark would give. Dropped and counted: measurements
// with a barcode that is in no table (a decoding error), and those before the first odometry or after the
// last, where there is no pose to see them from (the streams start and end seconds apart). Throws InputError
// that names a file which is missing, or "FILE:LINE: REASON: DETAIL"; bad are: not a number, not finite,
// wrong number of columns, time runs backwards (as once in each of four robots of dataset 9), negative range,
// beyond the sensor's maximum, outside its field of view, unknown landmark (a subject that has no true
// position).
ImportReport ImportMrclam(const MrclamImportOptions& options, Blob* log);

}  // namespace cairn::datasets
