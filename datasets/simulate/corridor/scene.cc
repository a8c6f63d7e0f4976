#include "datasets/simulate/corridor/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn::datasets::corridor {
namespace {

constexpr double kNear = 1e-9, kFar = std::numeric_limits<double>::infinity();
constexpr double kSightM = 8;  // pillars further along than that are not looked at

double DepthOf(const Opening& opening, bool open) {
  switch (opening.kind) {
    case OpeningKind::kDoor:
      return open ? 2.6 : 0.10;
    case OpeningKind::kElevator:
      return 0.18;
    case OpeningKind::kHallway:
      return 7;
    case OpeningKind::kCorner:
      return 5;
  }
  return 0;
}

// A room is wider than its door.
double RoomMarginM(const Opening& opening, bool open) {
  return opening.kind == OpeningKind::kDoor && open ? 1.2 : 0;
}

Vec3 Along(const Vec3& from, const Vec3& direction, double distance) {
  return {from.x + distance * direction.x, from.y + distance * direction.y, from.z + distance * direction.z};
}

double Reach(double from, double direction, double to) {
  const double distance = direction == 0 ? kFar : (to - from) / direction;
  return distance > kNear ? distance : kFar;
}

double ReachPillar(const Vec3& from, const Vec3& direction, const Pillar& pillar) {
  const double dx = from.x - pillar.x_m, dy = from.y - pillar.y_m;
  const double a = direction.x * direction.x + direction.y * direction.y;
  const double b = dx * direction.x + dy * direction.y;
  const double c = dx * dx + dy * dy - pillar.radius_m * pillar.radius_m;
  const double root = b * b - a * c;
  if (a < kNear || root < 0 || c < 0) return kFar;
  const double near = (-b - std::sqrt(root)) / a, far = (-b + std::sqrt(root)) / a;
  if (near > kNear && from.z + near * direction.z < pillar.height_m) return near;
  // Over its edge and down onto its top.
  const double top = Reach(from.z, direction.z, pillar.height_m);
  return direction.z < 0 && top > near && top < far ? top : kFar;
}

}  // namespace

Scene::Scene(const World& world, const Run& run) : world_(&world), run_(&run) {
  const auto metres = static_cast<std::size_t>(world.length_m + 2 * kCornerM) + 2;
  for (const Side side : {kOuter, kInner}) {
    buckets_[side].resize(metres);
    const auto fill = [&](const auto& things, auto list) {
      for (std::size_t i = 0; i < things.size(); ++i) {
        const auto first = static_cast<std::size_t>(std::max(0.0, things[i].x0_m + kCornerM));
        const auto last = static_cast<std::size_t>(std::max(0.0, things[i].x1_m + kCornerM));
        for (std::size_t m = first; m <= std::min(last, metres - 1); ++m)
          (buckets_[side][m].*list).push_back(i);
      }
    };
    fill(world.walls[side].openings, &Bucket::openings);
    fill(world.walls[side].panels, &Bucket::panels);
  }
}

const Scene::Bucket& Scene::BucketAt(Side side, double x_m) const {
  const double metre = std::clamp(x_m + kCornerM, 0.0, static_cast<double>(buckets_[side].size() - 1));
  return buckets_[side][static_cast<std::size_t>(metre)];
}

std::vector<Pillar> Scene::PillarsNear(double x_m, double time_s) const {
  std::vector<Pillar> pillars;
  for (std::size_t i = 0; i < run_->people.size(); ++i) {
    const Person& p = run_->people[i];
    const double x = p.x_m + p.speed_mps * time_s;
    if (std::abs(x - x_m) < kSightM) pillars.push_back({x, p.y_m, 0.2, p.height_m, Surface::kPerson, i});
  }
  for (std::size_t i = 0; i < run_->bins.size(); ++i) {
    const Bin& bin = run_->bins[i];
    if (std::abs(bin.x_m - x_m) < kSightM) pillars.push_back({bin.x_m, bin.y_m, 0.2, 0.65, Surface::kBin, i});
  }
  return pillars;
}

Hit Scene::CastWithin(Side side, std::size_t index, double distance, const Vec3& from,
                      const Vec3& direction) const {
  const Opening& opening = world_->walls[side].openings[index];
  const bool open = IsOpen(side, index);
  const double sign = side == kOuter ? 1 : -1, depth = DepthOf(opening, open),
               margin = RoomMarginM(opening, open);
  const Vec3 at = Along(from, direction, distance);
  const double back = Reach(at.y, direction.y, sign * (kHalfWidthM + depth));
  const double beside =
      Reach(at.x, direction.x, direction.x > 0 ? opening.x1_m + margin : opening.x0_m - margin);
  const double over = Reach(at.z, direction.z, direction.z > 0 ? (open ? kHeightM : opening.height_m) : 0);
  const double nearest = std::min({back, beside, over});
  const bool shallow = depth < 0.5;
  Hit hit{distance + nearest, Along(at, direction, nearest), Surface::kWithin, side, index};
  if (nearest == over && direction.z < 0)
    hit.surface = Surface::kFloor;
  else if (shallow)
    hit.surface = nearest == back ? Surface::kDoor : Surface::kReveal;
  return hit;
}

Hit Scene::CastAtWall(Side side, double distance, const Vec3& from, const Vec3& direction) const {
  const Vec3 at = Along(from, direction, distance);
  const Wall& wall = world_->walls[side];
  const Bucket& bucket = BucketAt(side, at.x);
  for (const std::size_t i : bucket.openings) {
    const Opening& opening = wall.openings[i];
    if (at.x >= opening.x0_m && at.x <= opening.x1_m && at.z <= opening.height_m)
      return CastWithin(side, i, distance, from, direction);
  }
  for (const std::size_t i : bucket.panels) {
    const Panel& panel = wall.panels[i];
    if (at.x >= panel.x0_m && at.x <= panel.x1_m && at.z >= panel.z0_m && at.z <= panel.z1_m)
      return {distance, at, Surface::kPanel, side, i};
  }
  return {distance, at, Surface::kWall, side, 0};
}

Hit Scene::Cast(const Vec3& from, const Vec3& direction, const std::vector<Pillar>& pillars) const {
  const Side side = direction.y > 0 ? kOuter : kInner;
  const double wall = Reach(from.y, direction.y, side == kOuter ? kHalfWidthM : -kHalfWidthM);
  const double level = Reach(from.z, direction.z, direction.z > 0 ? kHeightM : 0);
  const double end = Reach(from.x, direction.x, direction.x > 0 ? world_->length_m + kCornerM : -kCornerM);
  const double nearest = std::min({wall, level, end});
  Hit hit;
  if (nearest == wall)
    hit = CastAtWall(side, wall, from, direction);
  else if (nearest == level)
    hit = {level, Along(from, direction, level), direction.z > 0 ? Surface::kCeiling : Surface::kFloor, side,
           0};
  else
    hit = {end, Along(from, direction, end), Surface::kEnd, side, 0};
  for (const Pillar& pillar : pillars) {
    const double distance = ReachPillar(from, direction, pillar);
    if (distance >= hit.distance) continue;
    hit = {distance, Along(from, direction, distance), pillar.surface, side, pillar.index};
  }
  return hit;
}

}  // namespace cairn::datasets::corridor
