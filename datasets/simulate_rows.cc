#include "datasets/simulate_rows.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets {

double ToMilli(double value) { return std::round(value * 1e3) / 1e3; }
double ToMicro(double value) { return std::round(value * 1e6) / 1e6; }
double ToNanoAngle(double angle_rad) { return std::min(std::round(angle_rad * 1e9) / 1e9, 3.141592653); }

std::vector<double> Milli(std::vector<double> times_s) {
  for (double& time : times_s) time = ToMilli(time);
  return times_s;
}

void PutOdometry(const std::string& robot, const Drive& drive, const OdometryDraw& odometry, Blob& log) {
  std::vector<double> time, turn, forward;
  for (std::size_t i = 0; i < odometry.controls.size(); ++i) {
    time.push_back(ToMilli(drive.times_s[i]));
    turn.push_back(odometry.controls[i].turn_rad);
    forward.push_back(odometry.controls[i].forward_m);
  }
  log.PutVector(robot + "/odometry/time_s", time);
  log.PutVector(robot + "/odometry/turn_rad", turn);
  log.PutVector(robot + "/odometry/forward_m", forward);
}

void PutPoses(const std::string& prefix, const Drive& drive, Blob& log) {
  std::vector<double> time, x, y, heading;
  const auto add = [&](double time_s, const PoseM& pose) {
    time.push_back(ToMilli(time_s));
    x.push_back(ToMicro(pose.x_m));
    y.push_back(ToMicro(pose.y_m));
    heading.push_back(ToNanoAngle(pose.heading_rad));
  };
  PoseM pose = drive.start;
  add(0, pose);
  for (std::size_t i = 0; i < drive.controls.size(); ++i) {
    pose = Apply(pose, drive.controls[i]);
    add(drive.times_s[i], pose);
  }
  log.PutVector(prefix + "time_s", time);
  log.PutVector(prefix + "x_m", x);
  log.PutVector(prefix + "y_m", y);
  log.PutVector(prefix + "heading_rad", heading);
}

}  // namespace cairn::datasets
