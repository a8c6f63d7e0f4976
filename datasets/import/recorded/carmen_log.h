// What stands in a CARMEN log, line by line, before anything is made of it.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/common/text_file.h"
#include "datasets/import/log_rows.h"
#include "datasets/import/recorded/carmen_line.h"
#include "datasets/import/recorded/range_log.h"

namespace cairn::datasets {

// A laser's scans of one kind of message: FLASER and RAWLASER1 are two sources of the same laser.
struct CarmenSource {
  std::string message;
  std::size_t laser = 0;  // 0: in front, 1: at the rear, 2, 3, …
  std::size_t beams = 0, scans = 0;
  std::optional<double> start_rad, step_rad, max_range_m;  // of the messages that have them
  std::vector<Pose> mounts;  // the laser's pose as seen from the robot's, by each scan that tells
};

struct CarmenEvent {
  RangeEvent event;           // of a scan: `sensor` is the source, or kCarmenSonar
  std::optional<Pose> laser;  // the pose of the laser, of the messages that have it
};
inline constexpr std::uint32_t kCarmenSonar = static_cast<std::uint32_t>(-1);

struct CarmenLog {
  std::vector<CarmenSource> sources;
  std::vector<CarmenEvent> events;
  RangeThings things;  // of the events
  CarmenSonar sonar;   // the first scan's: cone and offsets; none: no offsets
  std::map<std::string, std::string, std::less<>> params;
  bool mended = false;  // it has lines of a program that mends poses

  // The number of a parameter; nothing where the log does not state it.
  std::optional<double> Param(const std::string& name) const;
  std::optional<double> PositiveParam(const std::string& name) const;  // nor where it is not above 0
};

// Reads it all; bad lines go to `bad`, what was read and what is not used to `report`.
CarmenLog ReadCarmenLog(const std::string& path, BadLines* bad, ImportReport* report);

}  // namespace cairn::datasets
