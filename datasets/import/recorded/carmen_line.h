// Lines of a CARMEN log (carmen.sourceforge.net, "Logging Data and Playing It Back", and the toolkit's own
// writer, src/logger/logwrite.c): a message each, its name first, behind its contents the time of the
// message, the host, and the time of the logger. RAWLASERn and ROBOTLASERn of the writer's first revision
// have no remission mode.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/common/fields.h"
#include "schema/geometry.h"

namespace cairn::datasets {

// What a message of a laser holds beside its ranges.
enum class CarmenForm {
  kOld,      // FLASER n r… laser x y theta, robot x y theta
  kOldBare,  // LASER3 n r…
  kRaw,      // RAWLASERn type start field resolution maximum accuracy remission-mode n r… m remission…
  kRobot,    // ROBOTLASERn as raw, laser x y theta, robot x y theta, tv rv, two safety distances, turn axis
};

struct CarmenLaser {
  CarmenForm form;
  std::size_t laser;  // 0: in front, 1: at the rear, 2, 3, …
};
// Nothing where the message is not of a laser.
std::optional<CarmenLaser> LaserOf(std::string_view message);
// Whether the message is one of CARMEN's, or of a program that mends its logs, that Cairn has no use for.
bool IsUnusedMessage(std::string_view message);

struct CarmenScan {
  double stamp_s = 0;
  std::vector<double> range_m;
  std::vector<float> remission;                            // of each range, or none
  std::optional<double> start_rad, step_rad, max_range_m;  // of the messages that have them
  std::optional<Pose> laser, robot;
};
struct CarmenSonar {
  double stamp_s = 0, cone_rad = 0;
  std::vector<double> range_m;
  std::vector<Pose> offsets;
};
struct CarmenPose {
  double stamp_s = 0;
  Pose pose;
};

// These throw LineError.
CarmenScan ParseScan(const Fields& line, CarmenForm form);
CarmenSonar ParseSonar(const Fields& line);  // SONAR cone n r… (x y theta)…
CarmenPose ParsePose(const Fields& line);  // ODOM x y theta tv rv acceleration; TRUEPOS x y theta, odometry's

}  // namespace cairn::datasets
