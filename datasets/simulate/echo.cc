#include "datasets/simulate/echo.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn::datasets {
namespace {

constexpr double kNoEcho = std::numeric_limits<double>::infinity();

struct Sonar {
  Point at;
  double heading_rad = 0, half_opening_rad = 0;
  Cone InView() const { return {at, heading_rad, half_opening_rad}; }
  Cone Axis() const { return {at, heading_rad, 0}; }
};

// The sonar, and the foot of the perpendicular from it, on the other side of a line.
struct Mirrored {
  Sonar sonar;
  Point foot;
};

Mirrored MirrorIn(const Wall& wall, const Sonar& sonar) {
  const double length = DistanceM(wall.a, wall.b);
  const Point u{(wall.b.x_m - wall.a.x_m) / length, (wall.b.y_m - wall.a.y_m) / length};
  const double along = (sonar.at.x_m - wall.a.x_m) * u.x_m + (sonar.at.y_m - wall.a.y_m) * u.y_m;
  const Point foot{wall.a.x_m + along * u.x_m, wall.a.y_m + along * u.y_m};
  const double heading = 2 * std::atan2(u.y_m, u.x_m) - sonar.heading_rad;
  return {{{2 * foot.x_m - sonar.at.x_m, 2 * foot.y_m - sonar.at.y_m}, heading, sonar.half_opening_rad},
          foot};
}

bool FacesFoot(const Sonar& sonar, const Wall& wall, Point foot) {
  const double length = DistanceM(wall.a, wall.b);
  if (DistanceM(wall.a, foot) > length || DistanceM(wall.b, foot) > length) return false;
  const double bearing = std::atan2(foot.y_m - sonar.at.y_m, foot.x_m - sonar.at.x_m);
  return std::abs(WrapAngle(bearing - sonar.heading_rad)) <= sonar.half_opening_rad;
}

// On which side of a line: positive to its left.
double SideOf(const Wall& line, Point p) {
  return (line.b.x_m - line.a.x_m) * (p.y_m - line.a.y_m) - (line.b.y_m - line.a.y_m) * (p.x_m - line.a.x_m);
}

bool OnSideOf(const Wall& line, Point side, const Wall& wall) {
  const double sign = std::copysign(1.0, SideOf(line, side));
  constexpr double kSlack = 1e-6;
  return sign * SideOf(line, wall.a) >= -kSlack && sign * SideOf(line, wall.b) >= -kSlack;
}

// The point of a disc that is nearest within the cone lies in the direction nearest to its centre.
double PersonM(const Sonar& sonar, Point person) {
  const double distance = DistanceM(sonar.at, person);
  if (distance <= kPersonRadiusM) return 0;
  const double off =
      WrapAngle(std::atan2(person.y_m - sonar.at.y_m, person.x_m - sonar.at.x_m) - sonar.heading_rad);
  const double beside = std::max(std::abs(off) - sonar.half_opening_rad, 0.0);
  const double across = distance * std::sin(beside);
  if (beside >= std::asin(kPersonRadiusM / distance)) return kNoEcho;
  return distance * std::cos(beside) - std::sqrt(kPersonRadiusM * kPersonRadiusM - across * across);
}

bool PlainAnswers(const Wall& wall, Point from, double range_m, const Luck& luck) {
  const double off_m = std::abs(SideOf(wall, from)) / DistanceM(wall.a, wall.b);
  const double angle = std::acos(std::min(1.0, off_m / std::max(range_m, 1e-9)));
  return luck.oblique < std::exp(-angle * angle / (2 * kPlainRad * kPlainRad));
}

// All that one reading may be an echo of; the nearest that can be heard is kept.
class Listener {
 public:
  Listener(const std::vector<Obstacle>& around, const RangeRing& ring, const Sonar& sonar, const Luck& luck)
      : around_(around), ring_(ring), sonar_(sonar), luck_(luck), cone_(sonar.InView()) {}

  void TakeAll() {
    for (const Obstacle& obstacle : around_) {
      if (ring_.sound && obstacle.surface == Surface::kMirror)
        TakeMirror(obstacle);
      else
        TakeWall(obstacle);
    }
  }

  void TakePerson(Point person) { Take(PersonM(sonar_, person), person, Cause::kPerson); }

  double range_m() const { return range_m_; }
  Cause cause() const { return cause_; }

 private:
  bool Hears(Point point) const {
    return std::ranges::none_of(around_,
                                [&](const Obstacle& other) { return Crosses(other.wall, sonar_.at, point); });
  }

  void Take(double range_m, Point point, Cause of) {
    if (!(range_m < range_m_) || !Hears(point)) return;
    range_m_ = range_m;
    cause_ = of;
  }

  Point World(Point seen) const { return {sonar_.at.x_m + seen.x_m, sonar_.at.y_m + seen.y_m}; }

  void TakeWall(const Obstacle& obstacle) {
    const auto seen = cone_.Nearest(obstacle.wall);
    if (!seen) return;
    const double range_m = DistanceM({}, *seen);
    if (ring_.sound && obstacle.surface == Surface::kPlain &&
        !PlainAnswers(obstacle.wall, sonar_.at, range_m, luck_))
      return;
    Take(range_m, World(*seen), obstacle.surface == Surface::kBeyondDoor ? Cause::kBeyondDoor : Cause::kWall);
  }

  void TakeMirror(const Obstacle& mirror) {
    const Mirrored mirrored = MirrorIn(mirror.wall, sonar_);
    if (FacesFoot(sonar_, mirror.wall, mirrored.foot))
      return Take(DistanceM(sonar_.at, mirrored.foot), mirrored.foot, Cause::kWall);
    const auto hit = sonar_.Axis().Nearest(mirror.wall);
    if (!hit || !Hears(World(*hit))) return;
    if (luck_.mirror < kMirrorAnswers) return TakeWall({mirror.wall, Surface::kRough});
    if (luck_.mirror < kMirrorAnswers + kMirrorLost) return;
    const double seen_m = InMirrorM(mirror.wall, mirrored.sonar);
    const bool first = luck_.mirror < kMirrorAnswers + kMirrorLost + kMirrorEcho;
    const double late_m = seen_m + luck_.late * std::max(ring_.max_range_m - seen_m, 0.0);
    Take(first ? seen_m : late_m, World(*hit), Cause::kMirror);
  }

  // What the mirror shows; not what lies behind it.
  double InMirrorM(const Wall& mirror, const Sonar& mirrored) const {
    std::vector<Wall> shown;
    for (const Obstacle& other : around_) {
      const bool same = DistanceM(other.wall.a, mirror.a) + DistanceM(other.wall.b, mirror.b) == 0;
      if (!same && other.surface != Surface::kBeyondDoor && OnSideOf(mirror, sonar_.at, other.wall))
        shown.push_back(other.wall);
    }
    return NearestWallM(shown, mirrored.at, mirrored.heading_rad, mirrored.half_opening_rad);
  }

  const std::vector<Obstacle>& around_;
  const RangeRing& ring_;
  const Sonar& sonar_;
  const Luck& luck_;
  Cone cone_;
  double range_m_ = kNoEcho;
  Cause cause_ = Cause::kNothing;
};

}  // namespace

Luck DrawLuck(const RangeRing& ring, Rng& rng) {
  Luck luck;
  luck.noise_m = ring.sd_m * rng.Normal();
  luck.lost = rng.Uniform() < ring.dropouts;
  luck.mirror = rng.Uniform();
  luck.late = rng.Uniform();
  return luck;
}

Sounding Listen(const std::vector<Obstacle>& around, const RangeRing& ring, const Pose& ring_pose, int beam,
                std::span<const Point> persons, const Luck& luck) {
  const Pose from = ring.BeamPose(ring_pose, beam);
  const Sonar sonar{{from.x_m, from.y_m}, from.heading_rad, ring.opening_rad / 2};
  Listener listener(around, ring, sonar, luck);
  listener.TakeAll();
  for (const Point person : persons) listener.TakePerson(person);
  const double range_m = listener.range_m() + luck.noise_m;
  const bool lost = luck.lost && listener.cause() != Cause::kBeyondDoor;
  if (lost || !(range_m <= ring.max_range_m))
    return {std::numeric_limits<double>::quiet_NaN(), Cause::kNothing};
  return {std::round(std::max(range_m, 0.0) * 1e3) / 1e3, listener.cause()};
}

}  // namespace cairn::datasets
