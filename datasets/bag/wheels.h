// Odometry of a differential drive from how far its two wheels have turned.
#pragma once

#include <memory>
#include <string>

#include "datasets/bag/readers.h"

namespace cairn::datasets::bag {

struct Wheels {
  std::string left, right;  // joints of sensor_msgs/JointState
  double radius_m = 0;
  double distance_m = 0;  // from one to the other
};
// "left_wheel_joint,right_wheel_joint,0.033,0.16". Throws InputError.
Wheels ParseWheels(const std::string& text);

// Of kJoints: poses that follow from the joints' positions, or from their velocities where a message has no
// positions. Messages of other joints are left out.
std::unique_ptr<TopicReader> ReadWheels(const Wheels& wheels, OdometryRows* rows);

}  // namespace cairn::datasets::bag
