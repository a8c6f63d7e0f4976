// Rows of a simulated log: what a drive and its odometry become in a file, rounded as people read them.
#pragma once

#include <string>
#include <vector>

#include "datasets/simulate/drive.h"
#include "datasets/simulate/odometry.h"
#include "schema/blob.h"

namespace cairn::datasets {

double ToMilli(double value);
double ToMicro(double value);
// A nanoradian; never beyond pi, which does not end there.
double ToNanoAngle(double angle_rad);

std::vector<double> Milli(std::vector<double> times_s);

// `robot`/odometry/…
void PutOdometry(const std::string& robot, const Drive& drive, const OdometryDraw& odometry, Blob& log);

// noise/heading_drift_rad_per_m, heading_walk_rad_per_sqrt_m, forward_ratio, turn_ratio: as they are.
void PutNoise(const OdometryNoise& noise, Blob& log);

// `robot`/observations/… without rows, and no landmarks.
void PutNoObservations(const std::string& robot, Blob& log);

// `prefix`time_s, x_m, y_m, heading_rad: the pose at the drive's start and at the end of each control.
void PutPoses(const std::string& prefix, const Drive& drive, Blob& log);

}  // namespace cairn::datasets
