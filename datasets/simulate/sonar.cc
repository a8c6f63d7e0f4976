#include "datasets/simulate/sonar.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/common/control.h"

namespace cairn::datasets {
namespace {

double Echo(const RangeRing& ring, const Pose& robot, int beam, const std::vector<Wall>& walls, Rng& rng) {
  const Pose from = ring.BeamPose(robot, beam);
  const double range_m = NearestWallM(walls, {from.x_m, from.y_m}, from.heading_rad, ring.opening_rad / 2) +
                         ring.sd_m * rng.Normal();
  const bool lost = rng.Uniform() < ring.dropouts;
  if (lost || range_m > ring.max_range_m) return std::numeric_limits<double>::quiet_NaN();
  return std::round(std::max(range_m, 0.0) * 1e3) / 1e3;
}

}  // namespace

double RangeRing::Heading(int beam) const { return WrapAngle(beam * 2 * std::numbers::pi / beams); }

Pose RangeRing::BeamPose(const Pose& ring, int beam) const {
  const double heading = ring.heading_rad + Heading(beam);
  return {ring.x_m + radius_m * std::cos(heading), ring.y_m + radius_m * std::sin(heading), heading};
}

void PutScans(const std::string& robot, const RangeRing& ring, const std::vector<double>& times_s,
              const std::vector<double>& ranges_m, Blob& log) {
  std::vector<double> x, y, heading;
  for (int beam = 0; beam < ring.beams; ++beam) {
    heading.push_back(ring.Heading(beam));
    x.push_back(ring.radius_m * std::cos(heading.back()));
    y.push_back(ring.radius_m * std::sin(heading.back()));
  }
  const std::string prefix = robot + "/" + ring.sensor + "/";
  log.PutVector(prefix + "time_s", times_s);
  log.Put(prefix + "range_m",
          Array::Of<double>({static_cast<std::int64_t>(times_s.size()), ring.beams}, ranges_m));
  log.PutVector(prefix + "beam_x_m", x);
  log.PutVector(prefix + "beam_y_m", y);
  log.PutVector(prefix + "beam_heading_rad", heading);
  log.PutScalar(prefix + "opening_rad", ring.opening_rad);
  log.PutScalar(prefix + "max_range_m", ring.max_range_m);
}

void PutSonar(const std::string& robot, const Drive& drive, const std::vector<double>& times_s,
              const std::vector<Wall>& walls, Rng& rng, Blob& log) {
  const RangeRing ring;
  std::vector<double> ranges;
  Pose pose = drive.start;
  for (const Control& control : drive.controls) {
    pose = Apply(pose, control);
    for (int beam = 0; beam < ring.beams; ++beam) ranges.push_back(Echo(ring, pose, beam, walls, rng));
  }
  PutScans(robot, ring, times_s, ranges, log);
}

void PutSegments(const std::string& prefix, const std::vector<Wall>& segments, Blob& log) {
  std::vector<double> x, y;
  for (const Wall& segment : segments) {
    for (const Point end : {segment.a, segment.b}) {
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
