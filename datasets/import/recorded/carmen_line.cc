#include "datasets/import/recorded/carmen_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace cairn::datasets {
namespace {

constexpr std::size_t kMostBeams = 100000;
constexpr double kMostRange_m = 1000;  // no sensor of a robot writes more, not even for 'nothing'

// Behind the contents, which end before field `end`, stand time, host and time.
void NeedEnd(const Fields& line, std::size_t end, const std::string& declared) {
  line.Need(end + 3, declared);
}

// Whether both lists, the first of which begins with its length in field `at`, leave `behind` fields.
bool ListsLeave(const Fields& line, std::size_t at, std::size_t behind) {
  try {
    const std::size_t remissions = at + 1 + line.Count(at, kMostBeams);
    return remissions + 1 + line.Count(remissions, kMostBeams) + behind == line.size();
  } catch (const LineError&) {
    return false;
  }
}

// Fills in the scan's geometry; returns the field of the number of readings.
std::size_t ParseConfiguration(const Fields& line, std::size_t behind, CarmenScan* scan) {
  constexpr std::size_t kStart = 2, kStep = 4, kMaximum = 5, kReadings = 8;
  scan->start_rad = line.Number(kStart);
  scan->step_rad = line.Number(kStep);
  scan->max_range_m = line.Number(kMaximum);
  if (!(*scan->step_rad > 0 && *scan->step_rad < std::numbers::pi))
    throw LineError{"no angular resolution", "field 5 is '" + std::string(line.Text(kStep)) +
                                                 "', in radians; allowed: above 0, below pi"};
  if (*scan->max_range_m <= 0)
    throw LineError{"no maximum range",
                    "field 6 is '" + std::string(line.Text(kMaximum)) + "', in metres; allowed: above 0"};
  const bool without_mode = !ListsLeave(line, kReadings, behind) && ListsLeave(line, kReadings - 1, behind);
  return without_mode ? kReadings - 1 : kReadings;
}

}  // namespace

std::optional<CarmenLaser> LaserOf(std::string_view message) {
  if (message == "FLASER") return CarmenLaser{CarmenForm::kOld, 0};
  if (message == "RLASER") return CarmenLaser{CarmenForm::kOld, 1};
  if (message.empty() || message.back() < '1' || message.back() > '5') return std::nullopt;
  const auto laser = static_cast<std::size_t>(message.back() - '1');
  message.remove_suffix(1);
  if (message == "LASER" && laser >= 2) return CarmenLaser{CarmenForm::kOldBare, laser};
  if (message == "RAWLASER") return CarmenLaser{CarmenForm::kRaw, laser};
  if (message == "ROBOTLASER") return CarmenLaser{CarmenForm::kRobot, laser};
  return std::nullopt;
}

bool IsUnusedMessage(std::string_view message) {
  static constexpr std::array kUnused = {"SYNC",
                                         "COMMENT",
                                         "NEFF",
                                         "GLOBALPOS",
                                         "NMEAGGA",
                                         "NMEARMC",
                                         "GPSNMEA",
                                         "BUMPER",
                                         "ARM",
                                         "SCANMARK",
                                         "POSITIONLASER",
                                         "IMU",
                                         "VECTORMOVE",
                                         "ROBOTVELOCITY",
                                         "BASEVELOCITY",
                                         "FOLLOWTRAJECTORY",
                                         "REMISSIONFLASER",
                                         "REMISSIONRLASER",
                                         "REMISSIONLASER3",
                                         "REMISSIONLASER4"};
  return std::ranges::find(kUnused, message) != kUnused.end();
}

CarmenScan ParseScan(const Fields& line, CarmenForm form) {
  CarmenScan scan;
  const bool configured = form == CarmenForm::kRaw || form == CarmenForm::kRobot;
  const bool posed = form == CarmenForm::kOld || form == CarmenForm::kRobot;
  const std::size_t behind = (posed ? 6U : 0U) + (form == CarmenForm::kRobot ? 5U : 0U);
  const std::size_t at = configured ? ParseConfiguration(line, behind + 3, &scan) : 1;
  const std::size_t beams = line.Count(at, kMostBeams);
  std::string declared = std::to_string(beams) + " readings";
  if (beams == 0) throw LineError{"no count", "the scan has no readings"};
  std::size_t end = at + 1 + beams;
  if (configured) {
    if (end >= line.size()) line.Need(end + 1, declared);
    const std::size_t remissions = line.Count(end, kMostBeams);
    declared += " and " + std::to_string(remissions) + " remissions";
    if (remissions == beams && end + remissions < line.size())
      for (std::size_t i = 0; i < beams; ++i)
        scan.remission.push_back(static_cast<float>(line.Number(end + 1 + i)));
    end += 1 + remissions;
  }
  const std::size_t poses = end;
  end += behind;
  NeedEnd(line, end, declared);
  scan.range_m = line.Ranges(at + 1, beams, kMostRange_m);
  if (posed) {
    scan.laser = line.PoseAt(poses);
    scan.robot = line.PoseAt(poses + 3);
  }
  scan.stamp_s = line.Stamp(end);
  return scan;
}

CarmenSonar ParseSonar(const Fields& line) {
  CarmenSonar scan;
  scan.cone_rad = line.Number(1);
  if (!(scan.cone_rad >= 0 && scan.cone_rad < std::numbers::pi))
    throw LineError{"no cone of a sonar", "field 2 is '" + std::string(line.Text(1)) + "', in radians"};
  const std::size_t sonars = line.Count(2, kMostBeams);
  if (sonars == 0) throw LineError{"no count", "the scan has no sonars"};
  NeedEnd(line, 3 + 4 * sonars, std::to_string(sonars) + " sonars");
  scan.range_m = line.Ranges(3, sonars, kMostRange_m);
  for (std::size_t s = 0; s < sonars; ++s) scan.offsets.push_back(line.PoseAt(3 + sonars + 3 * s));
  scan.stamp_s = line.Stamp(3 + 4 * sonars);
  return scan;
}

CarmenPose ParsePose(const Fields& line) {
  NeedEnd(line, 7, "six values");
  return {line.Stamp(7), line.PoseAt(1)};
}

}  // namespace cairn::datasets
