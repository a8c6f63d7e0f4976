#include "datasets/simulate/rows.h"

#include <algorithm>
#include <cmath>

#include "datasets/common/control.h"
#include "schema/kinds/log.h"

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
  PutFields(robot + "/odometry/", kinds::Log::Odometry{time, turn, forward}, &log);
}

void PutNoise(const OdometryNoise& noise, Blob& log) {
  log.PutScalar("noise/heading_drift_rad_per_m", noise.heading_drift_rad_per_m);
  log.PutScalar("noise/heading_walk_rad_per_sqrt_m", noise.heading_walk_rad_per_sqrt_m);
  log.PutScalar("noise/forward_ratio", noise.forward_ratio);
  log.PutScalar("noise/turn_ratio", noise.turn_ratio);
}

void PutNoObservations(const std::string& robot, Blob& log) {
  log.Put("landmarks", Array::Texts({}));
  const std::vector<double> none;
  PutFields(robot + "/observations/",
            kinds::Log::Observations{none, none, none, std::vector<std::int32_t>(), {}}, &log);
}

void PutPoses(const std::string& prefix, const Drive& drive, Blob& log) {
  std::vector<double> time;
  std::vector<Pose> poses;
  const auto add = [&](double time_s, const Pose& pose) {
    time.push_back(ToMilli(time_s));
    poses.push_back({ToMicro(pose.x_m), ToMicro(pose.y_m), ToNanoAngle(pose.heading_rad)});
  };
  Pose pose = drive.start;
  add(0, pose);
  for (std::size_t i = 0; i < drive.controls.size(); ++i) {
    pose = Apply(pose, drive.controls[i]);
    add(drive.times_s[i], pose);
  }
  kinds::PoseTable table;
  table.Set(time, poses);
  PutFields(prefix, table, &log);
}

}  // namespace cairn::datasets
