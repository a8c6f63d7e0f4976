#include "datasets/simulate_sonar.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace cairn::datasets {
namespace {

double Echo(const PoseM& robot, int beam, const std::vector<Wall>& walls, Rng& rng) {
  const double heading = robot.heading_rad + SonarHeading(beam);
  const PointM at{robot.x_m + kSonarRingM * std::cos(heading), robot.y_m + kSonarRingM * std::sin(heading)};
  const double range_m = NearestWallM(walls, at, heading, kSonarOpeningRad / 2) + kSonarSdM * rng.Normal();
  const bool lost = rng.Uniform() < kSonarDropouts;
  if (lost || range_m > kSonarMaxRangeM) return std::numeric_limits<double>::quiet_NaN();
  return std::round(std::max(range_m, 0.0) * 1e3) / 1e3;
}

}  // namespace

double SonarHeading(int beam) { return WrapAngle(beam * 2 * std::numbers::pi / kSonars); }

void PutScans(const std::string& robot, const std::vector<double>& times_s,
              const std::vector<double>& ranges_m, Blob& log) {
  std::vector<double> x, y, heading;
  for (int beam = 0; beam < kSonars; ++beam) {
    heading.push_back(SonarHeading(beam));
    x.push_back(kSonarRingM * std::cos(heading.back()));
    y.push_back(kSonarRingM * std::sin(heading.back()));
  }
  const std::string sonar = robot + "/sonar/";
  log.PutVector(sonar + "time_s", times_s);
  log.Put(sonar + "range_m",
          Array::Of<double>({static_cast<std::int64_t>(times_s.size()), kSonars}, ranges_m));
  log.PutVector(sonar + "beam_x_m", x);
  log.PutVector(sonar + "beam_y_m", y);
  log.PutVector(sonar + "beam_heading_rad", heading);
  log.PutScalar(sonar + "opening_rad", kSonarOpeningRad);
  log.PutScalar(sonar + "max_range_m", kSonarMaxRangeM);
}

void PutSonar(const std::string& robot, const Drive& drive, const std::vector<double>& times_s,
              const std::vector<Wall>& walls, Rng& rng, Blob& log) {
  std::vector<double> ranges;
  PoseM pose = drive.start;
  for (const Control& control : drive.controls) {
    pose = Apply(pose, control);
    for (int beam = 0; beam < kSonars; ++beam) ranges.push_back(Echo(pose, beam, walls, rng));
  }
  PutScans(robot, times_s, ranges, log);
}

void PutSegments(const std::string& prefix, const std::vector<Wall>& segments, Blob& log) {
  std::vector<double> x, y;
  for (const Wall& segment : segments) {
    for (const PointM end : {segment.a, segment.b}) {
      x.push_back(std::round(end.x_m * 1e6) / 1e6);
      y.push_back(std::round(end.y_m * 1e6) / 1e6);
    }
  }
  const std::vector<std::int64_t> shape{static_cast<std::int64_t>(segments.size()), 2};
  log.Put(prefix + "x_m", Array::Of<double>(shape, x));
  log.Put(prefix + "y_m", Array::Of<double>(shape, y));
}

void PutWalls(const std::vector<Wall>& walls, Blob& log) { PutSegments("truth/walls/", walls, log); }

}  // namespace cairn::datasets
