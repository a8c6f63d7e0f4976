// A log as a bag of ROS 1: what robots of that log would have recorded, for walk-throughs and tests.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::datasets {

// Of a `log` (schema/FORMAT.md) the bytes of a bag, plain and with an index. Times begin at 1e9 s, for a
// header without a time is none. Of several robots the topics lie in namespaces, /robot0, /robot1, …:
//   /odom          nav_msgs/Odometry, where the wheels say that the robot is;
//   /joint_states  sensor_msgs/JointState, left_wheel_joint and right_wheel_joint, of 0.1 m radius and 0.4 m
//                  apart;
//   /sonar_00, …   sensor_msgs/Range, of sensors of a ring (`sonar`, `infrared`); no answer is the reach;
//   /tf_static     where they sit on base_link;
//   /markers       aruco_msgs/MarkerArray, where landmarks were seen of which it is known which they are;
//   /landmarks     geometry_msgs/PoseArray, where others were;
//   /contacts      std_msgs/Header, when the robot was at one, whichever;
//   /truth         geometry_msgs/PoseStamped.
// Other sensors and observations of robots are left out.
std::string BagOfLog(const Blob& log);

}  // namespace cairn::datasets
