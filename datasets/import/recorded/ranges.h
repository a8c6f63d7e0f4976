// `cairn import pioneer`, `dpslam`, `wean`: recorded range logs of single makers, plain or gzipped
// (docs/datasets.md says where from). All poses in them are odometry.
#pragma once

#include <string>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct RangeImportOptions {
  std::string path;
  bool skip_bad = false;  // skip bad lines and count them by reason, instead of stopping at the first
  NoiseParameters noise;  // none of the recordings states any
};

// A folder with od.txt (ms, mm, mm, 0.1 degree), sonar.txt and laser.txt (ms, mm …) of a Pioneer robot, rows
// of the same number at the same time. Eight sonars at -90, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90 degrees,
// the outer two 0.19 m to the side, each with a cone of 20 degrees; 361 laser beams, half a degree apart.
ImportReport ImportPioneer(const RangeImportOptions& options, Blob* log);

// A log of DP-SLAM: `Odometry x y theta` and behind it `Laser 181 r…`, a degree apart, in metres; without
// times, so that scans are numbered. From 8.18 m on nothing was met.
ImportReport ImportDpSlam(const RangeImportOptions& options, Blob* log);

// A log of Wean Hall (CMU): `O x y theta time` and `L x y theta, x y theta of the laser, 180 ranges, time` in
// centimetres. The laser sits 0.25 m ahead. From 81.8 m on nothing was met.
ImportReport ImportWean(const RangeImportOptions& options, Blob* log);

}  // namespace cairn::datasets
