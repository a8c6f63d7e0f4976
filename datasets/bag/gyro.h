// Odometry whose turns are a gyro's: wheels slip, a gyro drifts, and how it drifts is seen while the robot
// stands.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "datasets/bag/readers.h"
#include "datasets/import/log_rows.h"

namespace cairn::datasets::bag {

struct GyroRow {
  double time_s = 0;
  PointInSpace rate_radps;  // about the axes of its frame
};
struct GyroRows {
  std::string topic, frame;
  double factor = 1;  // rates are multiplied by
  SpooledRows<GyroRow> rows;
};
// Of sensor_msgs/Imu. Throws LineError where a message says that it has no rates (REP 145), or none that a
// robot turns at.
std::unique_ptr<TopicReader> ReadGyro(GyroRows* rows);

// Gives the odometry the turns of the gyro, which sits at `mount` on the robot; the way between two poses
// stays what it was, relative to the heading in its middle. The bias is the mean rate while the odometry
// stands for a second or longer; between two halts it goes from the one's to the other's. Where the gyro has
// a gap of more than half a second the turn stays that of the odometry. Says what it did in the report, and
// where the two contradict each other.
void TurnByGyro(const GyroRows& gyro, const Transform& mount, SpooledRows<PoseRow>* poses,
                ImportReport* report);

}  // namespace cairn::datasets::bag
