// What a robot's odometry makes of a drive.
#pragma once

#include <optional>
#include <vector>

#include "datasets/common/control.h"
#include "datasets/simulate/drive.h"
#include "schema/rng.h"

namespace cairn::datasets {

struct OdometryNoise {
  double heading_drift_rad_per_m = 0;      // sd of a constant drift of the heading
  double heading_walk_rad_per_sqrt_m = 0;  // sd of the heading's random walk
  double forward_ratio =
      0.02;                  // sd of a scale that is constant over the log, and of each control's way besides
  double turn_ratio = 0.02;  // sd of each turn's error, a fraction of the turn
};

// Of the pose in which the odometry ends.
struct ErrorRange {
  double low_m = 0;
  double high_m = 0;
  double least_heading_rad = 0;  // the heading is off by so much or more, up to pi
};

struct OdometryDraw {
  std::vector<Control> controls;  // as measured, to a microradian and a micrometre
  double final_error_m = 0;  // between the end of the dead reckoning and the true end, from the true start
  int redraws = 0;           // before this one
  double drift_factor = 1;   // by which the drift was scaled to fit; 1: it was not
};

// Where the controls lead from `start`.
Pose DeadReckon(const Pose& start, const std::vector<Control>& controls);

// Draws the errors anew until the final error lies in `range`, a hundred times; after that it looks for a
// factor of each draw's drift that puts it there. Nothing where a thousand draws do not fit.
std::optional<OdometryDraw> DrawOdometry(const Drive& drive, const OdometryNoise& noise, ErrorRange range,
                                         Rng& rng);

}  // namespace cairn::datasets
