#include "datasets/hall/sounding.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/simulate_sonar.h"

namespace cairn::datasets {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kHalfOpeningRad = kSonarOpeningRad / 2;

struct Sonar {
  PointM at;
  double heading_rad = 0;
};

// The sonar, and the foot of the perpendicular from it, on the other side of a line.
struct Mirrored {
  Sonar sonar;
  PointM foot;
};

Mirrored MirrorIn(const Wall& wall, const Sonar& sonar) {
  const double length = DistanceM(wall.a, wall.b);
  const PointM u{(wall.b.x_m - wall.a.x_m) / length, (wall.b.y_m - wall.a.y_m) / length};
  const double along = (sonar.at.x_m - wall.a.x_m) * u.x_m + (sonar.at.y_m - wall.a.y_m) * u.y_m;
  const PointM foot{wall.a.x_m + along * u.x_m, wall.a.y_m + along * u.y_m};
  const double heading = 2 * std::atan2(u.y_m, u.x_m) - sonar.heading_rad;
  return {{{2 * foot.x_m - sonar.at.x_m, 2 * foot.y_m - sonar.at.y_m}, heading}, foot};
}

double InConeM(const std::vector<Wall>& walls, const Sonar& sonar) {
  return NearestWallM(walls, sonar.at, sonar.heading_rad, kHalfOpeningRad);
}

bool FacesFoot(const Sonar& sonar, const Wall& wall, PointM foot) {
  const double length = DistanceM(wall.a, wall.b);
  if (DistanceM(wall.a, foot) > length || DistanceM(wall.b, foot) > length) return false;
  const double bearing = std::atan2(foot.y_m - sonar.at.y_m, foot.x_m - sonar.at.x_m);
  return std::abs(WrapAngle(bearing - sonar.heading_rad)) <= kHalfOpeningRad;
}

// The point of a disc that is nearest within the cone lies in the direction nearest to its centre.
double PersonM(const Sonar& sonar, PointM person) {
  const double distance = DistanceM(sonar.at, person);
  if (distance <= kPersonRadiusM) return 0;
  const double off =
      WrapAngle(std::atan2(person.y_m - sonar.at.y_m, person.x_m - sonar.at.x_m) - sonar.heading_rad);
  const double beside = std::max(std::abs(off) - kHalfOpeningRad, 0.0);
  const double across = distance * std::sin(beside);
  if (beside >= std::asin(kPersonRadiusM / distance)) return kInfinity;
  return distance * std::cos(beside) - std::sqrt(kPersonRadiusM * kPersonRadiusM - across * across);
}

struct Nearest {
  double range_m = kInfinity;
  Cause cause = Cause::kNothing;
  void Take(double range, Cause of) {
    if (range < range_m) *this = {range, of};
  }
};

// By way of the smooth walls.
void ListenToMirrors(const Hall& hall, const Sonar& sonar, const Luck& luck, Nearest* nearest) {
  for (const Wall& wall : hall.smooth) {
    const Mirrored mirrored = MirrorIn(wall, sonar);
    if (FacesFoot(sonar, wall, mirrored.foot)) {
      nearest->Take(DistanceM(sonar.at, mirrored.foot), Cause::kWall);
      continue;
    }
    if (NearestWallM({wall}, sonar.at, sonar.heading_rad, 0) == kInfinity) continue;
    if (luck.mirror < kMirrorAnswers) {
      nearest->Take(InConeM({wall}, sonar), Cause::kWall);
      continue;
    }
    if (luck.mirror < kMirrorAnswers + kMirrorLost) continue;
    const double seen_m = InConeM(hall.rough, mirrored.sonar);
    const bool first = luck.mirror < kMirrorAnswers + kMirrorLost + kMirrorEcho;
    const double late_m = seen_m + luck.late * std::max(kSonarMaxRangeM - seen_m, 0.0);
    nearest->Take(first ? seen_m : late_m, Cause::kMirror);
  }
}

}  // namespace

Luck DrawLuck(Rng& rng) {
  Luck luck;
  luck.noise_m = kSonarSdM * rng.Normal();
  luck.lost = rng.Uniform() < kSonarDropouts;
  luck.mirror = rng.Uniform();
  luck.late = rng.Uniform();
  return luck;
}

Sounding Listen(const Hall& hall, const PoseM& robot, int beam, const std::optional<PointM>& person,
                const Luck& luck) {
  const double heading = robot.heading_rad + SonarHeading(beam);
  const Sonar sonar{
      {robot.x_m + kSonarRingM * std::cos(heading), robot.y_m + kSonarRingM * std::sin(heading)}, heading};
  Nearest nearest;
  nearest.Take(InConeM(hall.rough, sonar), Cause::kWall);
  nearest.Take(InConeM(hall.rooms, sonar), Cause::kBeyondDoor);
  if (person) nearest.Take(PersonM(sonar, *person), Cause::kPerson);
  ListenToMirrors(hall, sonar, luck, &nearest);
  const double range_m = nearest.range_m + luck.noise_m;
  const bool lost = luck.lost && nearest.cause != Cause::kBeyondDoor;
  if (lost || !(range_m <= kSonarMaxRangeM))
    return {std::numeric_limits<double>::quiet_NaN(), Cause::kNothing};
  return {std::round(std::max(range_m, 0.0) * 1e3) / 1e3, nearest.cause};
}

}  // namespace cairn::datasets
