// Rooms for tests: walls that a ring of 24 sonars on a turret hears, from a robot that drives in them with
// odometry that drifts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "pipelines/local_map/grids/plane.h"
#include "pipelines/local_map/grids/ring.h"
#include "schema/geometry.h"
#include "schema/rng.h"

namespace cairn::local_map {

inline constexpr double kTestOpeningRad = 0.2618;  // of a sonar's cone, in full

struct TestWall {
  Point a, b;
};

inline std::vector<Pose> RingBeams(int count = 24, double radius_m = 0.25) {
  std::vector<Pose> beams;
  for (int b = 0; b < count; ++b) {
    const double heading = b * 2 * std::numbers::pi / count;
    beams.push_back({radius_m * std::cos(heading), radius_m * std::sin(heading), heading});
  }
  return beams;
}

// Distance to the nearest point of the walls within the cone; infinite where there is none. Nothing can hide
// the nearest point.
inline double InConeM(const std::vector<TestWall>& walls, const Pose& from, double half_opening_rad) {
  const double c = std::cos(from.heading_rad), s = std::sin(from.heading_rad);
  const double slope = std::tan(half_opening_rad);
  double nearest = std::numeric_limits<double>::infinity();
  for (const TestWall& wall : walls) {
    const auto turned = [&](Point p) {
      const double x = p.x_m - from.x_m, y = p.y_m - from.y_m;
      return Point{c * x + s * y, -s * x + c * y};
    };
    const Point a = turned(wall.a), b = turned(wall.b);
    double first = 0, last = 1;  // the part of the wall in the cone: |y| <= slope x
    const auto cut = [&](double at_a, double at_b) {
      if (at_a < 0 && at_b < 0) last = -1;
      if (at_a < 0 && at_b >= 0) first = std::max(first, at_a / (at_a - at_b));
      if (at_a >= 0 && at_b < 0) last = std::min(last, at_a / (at_a - at_b));
    };
    cut(slope * a.x_m - a.y_m, slope * b.x_m - b.y_m);
    cut(slope * a.x_m + a.y_m, slope * b.x_m + b.y_m);
    if (first > last) continue;
    const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
    const double foot = -(a.x_m * dx + a.y_m * dy) / std::max(dx * dx + dy * dy, 1e-18);
    const double at = std::clamp(foot, first, last);
    nearest = std::min(nearest, std::hypot(a.x_m + at * dx, a.y_m + at * dy));
  }
  return nearest;
}

// What 24 sonars of 15 degrees hear: NaN beyond 6 m, and of one in fifty; the others off by 3 cm.
inline std::vector<double> SonarScan(const std::vector<TestWall>& walls, const Pose& robot, double turret_rad,
                                     Rng& rng) {
  std::vector<double> ranges;
  const Pose turret = Compose(robot, {0, 0, turret_rad});
  for (const Pose& beam : RingBeams()) {
    const double range = InConeM(walls, Compose(turret, beam), kTestOpeningRad / 2) + 0.03 * rng.Normal();
    const bool heard = rng.Uniform() >= 0.02 && range <= 6;
    ranges.push_back(heard ? range : std::numeric_limits<double>::quiet_NaN());
  }
  return ranges;
}

// A laser of 181 rays over the half circle ahead.
inline std::vector<Pose> LaserBeams() {
  std::vector<Pose> beams;
  for (int b = -90; b <= 90; ++b) beams.push_back({0.1, 0, RadOf(b)});
  return beams;
}

// What rays see up to `reach_m`, off by 1 cm; NaN beyond and of one ray in fifty. `exact`: off by nothing,
// and all answer.
inline std::vector<double> RayScan(const std::vector<TestWall>& walls, const std::vector<Pose>& beams,
                                   double reach_m, const Pose& robot, Rng& rng, bool exact = false) {
  constexpr double kRay_rad = 1e-3;
  std::vector<double> ranges;
  for (const Pose& beam : beams) {
    const double range = InConeM(walls, Compose(robot, beam), kRay_rad) + (exact ? 0 : 0.01) * rng.Normal();
    const bool seen = (rng.Uniform() >= 0.02 || exact) && range <= reach_m;
    ranges.push_back(seen ? range : std::numeric_limits<double>::quiet_NaN());
  }
  return ranges;
}

inline std::vector<double> LaserScan(const std::vector<TestWall>& walls, const Pose& robot, Rng& rng) {
  return RayScan(walls, LaserBeams(), 10, robot, rng);
}

// A rectangle, turned about `centre`, whose heading is the rectangle's.
inline std::vector<TestWall> TestBox(double width_m, double depth_m, const Pose& centre) {
  std::vector<Point> corners;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const Pose at = Compose(centre, {x * width_m / 2, y * depth_m / 2, 0});
    corners.push_back({at.x_m, at.y_m});
  }
  std::vector<TestWall> walls;
  for (std::size_t k = 0; k < 4; ++k) walls.push_back({corners[k], corners[(k + 1) % 4]});
  return walls;
}

// A room of 5 to 9 by 5 to 8 m about the origin, turned by any angle, with a doorway, furniture along the
// walls and in the middle, of which one piece in four stands askew. A robot finds its way round it at 1.2 m
// from the walls.
struct TestRoom {
  explicit TestRoom(std::uint64_t seed) : rng(seed, 77) {
    width_m = rng.Uniform(5, 9);
    depth_m = rng.Uniform(5, 8);
    turned_rad = rng.Uniform(-std::numbers::pi, std::numbers::pi);
    AddBox(width_m, depth_m, {});
    const TestWall right = walls[1];  // the doorway is a metre of it
    const auto on = [&](double share) {
      return Point{right.a.x_m + share * (right.b.x_m - right.a.x_m),
                   right.a.y_m + share * (right.b.y_m - right.a.y_m)};
    };
    walls[1] = {right.a, on(0.5 - 0.5 / depth_m)};
    walls.push_back({on(0.5 + 0.5 / depth_m), right.b});
    for (int side = 0; side < 4; ++side) {
      const double length = (side % 2 == 0 ? width_m : depth_m), away = (side % 2 == 0 ? depth_m : width_m);
      for (int piece = 0; piece < 2; ++piece) {
        const double deep = rng.Uniform(0.3, 0.6), wide = rng.Uniform(0.4, 1.2);
        const double along = rng.Uniform(-length / 2 + 0.6, length / 2 - 0.6);
        if (side == 1 && std::abs(along) < 1.2) continue;
        const Pose facing{0, 0, (side - 1) * std::numbers::pi / 2};
        AddBox(deep, wide, Compose(facing, {away / 2 - deep / 2 - 0.02, along, Askew()}));
      }
    }
    for (int piece = 0; piece < 2; ++piece) {
      const double reach_x = width_m / 2 - 2.4, reach_y = depth_m / 2 - 2.4;
      AddBox(0.5, rng.Uniform(0.4, 0.9),
             {rng.Uniform(-reach_x, reach_x), rng.Uniform(-reach_y, reach_y), Askew()});
    }
  }

  Rng rng;
  double width_m, depth_m, turned_rad;
  std::vector<TestWall> walls;

 private:
  double Askew() { return rng.Uniform() < 0.25 ? rng.Uniform(-0.7, 0.7) : 0; }
  void AddBox(double width, double depth, const Pose& centre) {
    for (const TestWall& wall : TestBox(width, depth, Compose({0, 0, turned_rad}, centre)))
      walls.push_back(wall);
  }
};

// Drives round and round a room, turning at its corners, its turret swinging by 45 degrees; five scans a
// second at 0.4 m/s. Odometry starts at 0 and drifts as in `simulate loop` (base).
class TestDrive {
 public:
  TestDrive(std::vector<TestWall> walls, const Pose& start, double width_m, double depth_m,
            std::uint64_t seed)
      : walls_(std::move(walls)), truth_(start), side_m_{width_m, depth_m}, rng_(seed, 78) {
    drift_rad_per_m_ = RadOf(0.06) * rng_.Normal();
    scale_ = 1 + 0.02 * rng_.Normal();
  }
  explicit TestDrive(const TestRoom& room, std::uint64_t seed)
      : TestDrive(room.walls,
                  Compose({0, 0, room.turned_rad}, {1.2 - room.width_m / 2, 1.2 - room.depth_m / 2, 0}),
                  room.width_m - 2.4, room.depth_m - 2.4, seed) {}

  // The next step and what is heard after it.
  RingScan Next() {
    constexpr double kStepM = 0.08, kTurnRad = std::numbers::pi / 20;
    const bool turns = travelled_m_ >= side_m_[side_ % 2];
    if (turns) {
      Move(kTurnRad, 0);
      if (++turned_ == 10) {
        turned_ = 0;
        travelled_m_ = 0;
        ++side_;
      }
    } else {
      Move(0, kStepM);
      travelled_m_ += kStepM;
    }
    ++scans_;
    const double turret = RadOf(45) * std::sin(0.15 * scans_);
    ranges_ = SonarScan(walls_, truth_, turret, rng_);
    return {0.2 * scans_, turret, ranges_};
  }
  const Pose& truth() const { return truth_; }
  const Pose& odometry() const { return odometry_; }
  // By how much a direction of the world differs in the odometric frame.
  double TurnedRad() const { return odometry_.heading_rad - truth_.heading_rad; }

 private:
  void Move(double turn_rad, double forward_m) {
    const auto step = [](Pose* pose, double turn, double forward) {
      *pose = Compose(Compose(*pose, {0, 0, turn}), {forward, 0, 0});
    };
    step(&truth_, turn_rad, forward_m);
    const double heading = drift_rad_per_m_ * forward_m + RadOf(0.5) * std::sqrt(forward_m) * rng_.Normal();
    step(&odometry_, turn_rad * (1 + 0.02 * rng_.Normal()) + heading,
         forward_m * scale_ * (1 + 0.02 * rng_.Normal()));
  }

  std::vector<TestWall> walls_;
  Pose truth_, odometry_;
  double side_m_[2];
  Rng rng_;
  double drift_rad_per_m_ = 0, scale_ = 1, travelled_m_ = 0;
  int side_ = 0, turned_ = 0, scans_ = 0;
  std::vector<double> ranges_;
};

}  // namespace cairn::local_map
