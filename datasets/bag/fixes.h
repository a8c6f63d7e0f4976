// Positions of satellite navigation as metres on the ground.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/bag/readers.h"
#include "datasets/import/log_rows.h"

namespace cairn::datasets::bag {

struct Fix {
  double time_s = 0;
  std::size_t number = 0;
  double latitude_deg = 0, longitude_deg = 0, altitude_m = 0;
  double variance_m2 = 0;  // of east and north together, half of it; 0: not known
};
struct FixRows {
  std::string topic, frame;
  std::vector<Fix> fixes;
  std::int64_t without = 0;  // messages that say there is no fix
};
// Of sensor_msgs/NavSatFix. A message without a fix is no bad one.
std::unique_ptr<TopicReader> ReadFixes(FixRows* rows);

// East and north of `origin`, which is else set to the first fix, in metres on the plane that touches the
// Earth (WGS 84) there; the heading is the course over a metre at least, and stays what it was where the
// robot stands. Where fixes are missing there are no poses. `antenna`: its place on the robot, where that is
// known: poses are then the robot's own, with its headings, if the fixes are exact enough for that to matter
// and there is odometry, in the order of time (antenna.h). Says in the report what truth that is.
std::vector<PoseRow> PosesOfFixes(const FixRows& rows, const std::optional<Pose>& antenna,
                                  const SpooledRows<PoseRow>& odometry, std::optional<Fix>* origin,
                                  ImportReport* report);

}  // namespace cairn::datasets::bag
