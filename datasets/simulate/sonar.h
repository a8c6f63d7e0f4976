// Rings of range sensors on a robot, and sonars in corridors.
#pragma once

#include <string>

#include "datasets/common/walls.h"
#include "datasets/simulate/drive.h"
#include "schema/blob.h"

namespace cairn::datasets {

inline constexpr int kSonars = 24;
inline constexpr double kSonarRingM = 0.25;         // radius of the ring
inline constexpr double kSonarMaxRangeM = 6;        // beyond it there is no echo
inline constexpr double kSonarOpeningRad = 0.2618;  // 15 degrees, full
inline constexpr double kSonarSdM = 0.03;
inline constexpr double kSonarDropouts = 0.02;  // share of the echoes that are lost

// Sensors at even angles, the first one ahead; their beams begin on the ring.
struct RangeRing {
  std::string sensor = "sonar";
  bool sound = true;  // mirrors for sound are none for the others
  int beams = kSonars;
  double radius_m = kSonarRingM, max_range_m = kSonarMaxRangeM, opening_rad = kSonarOpeningRad;
  double sd_m = kSonarSdM, dropouts = kSonarDropouts;

  double Heading(int beam) const;
  // Of a beam, where the ring's centre is and the way it is turned are given.
  Pose BeamPose(const Pose& ring, int beam) const;
};

// Puts `robot`/sonar/… (schema/FORMAT.md, range scans): `ranges_m` scan by scan, NaN where no echo came.
void PutScans(const std::string& robot, const RangeRing& ring, const std::vector<double>& times_s,
              const std::vector<double>& ranges_m, Blob& log);

// Puts `robot`/sonar/…: a scan at the end of each control. A sonar hears the nearest wall in its cone; there
// are no specular reflections. `times_s`: as the log has them.
void PutSonar(const std::string& robot, const Drive& drive, const std::vector<double>& times_s,
              const std::vector<Wall>& walls, Rng& rng, Blob& log);

// `prefix`x_m, y_m: both ends of each.
void PutSegments(const std::string& prefix, const std::vector<Wall>& segments, Blob& log);

// truth/walls/…
void PutWalls(const std::vector<Wall>& walls, Blob& log);

}  // namespace cairn::datasets
