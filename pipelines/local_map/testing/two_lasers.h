// A robot with two lasers, which drives round and round a room.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "pipelines/local_map/testing/room.h"

namespace cairn::local_map {

struct TestLaser {
  Pose mount, told;  // where it sits, and where it is said to
  double view_rad = std::numbers::pi;
  std::vector<TestWall> walls = {};  // beside the room's, at its height alone
  std::vector<double> range_m = {};  // of all scans
  static constexpr int kBeams = 121;

  std::vector<Pose> Beams(const Pose& at) const {
    std::vector<Pose> beams;
    for (int b = 0; b < kBeams; ++b) {
      const Pose beam = Compose(at, {0, 0, view_rad * (b / (kBeams - 1.0) - 0.5)});
      beams.push_back({beam.x_m, beam.y_m, WrapAngle(beam.heading_rad)});
    }
    return beams;
  }
  // Up to 10 m, off by 1 cm; NaN beyond.
  void Scan(std::vector<TestWall> room, const Pose& robot, Rng& rng) {
    constexpr double kRay_rad = 1e-3;
    room.insert(room.end(), walls.begin(), walls.end());
    for (const Pose& beam : Beams(mount)) {
      const double range = InConeM(room, Compose(robot, beam), kRay_rad) + 0.01 * rng.Normal();
      range_m.push_back(range <= 10 ? range : std::numeric_limits<double>::quiet_NaN());
    }
  }
};

struct TwoLaserDrive {
  std::vector<TestLaser> lasers;
  std::vector<Pose> steps, truth;

  // Five scans a second, 40 of them along each side of 3.2 m and 10 in each turn to the left.
  TwoLaserDrive(std::vector<TestLaser> two, const std::vector<TestWall>& room, int sides, bool turns = true)
      : lasers(std::move(two)) {
    Rng rng(4);
    Pose robot{-1.6, -1.6, 0};
    for (int k = 0; k < sides * 50; ++k) {
      const bool turn = k % 50 >= 40;
      if (turn && !turns) break;
      steps.push_back(turn ? Pose{0, 0, std::numbers::pi / 20} : Pose{0.08, 0, 0});
      robot = Compose(robot, steps.back());
      truth.push_back(robot);
      for (TestLaser& laser : lasers) laser.Scan(room, robot, rng);
    }
  }
};

// Of 7 by 7 m about the origin, with furniture along its walls.
inline std::vector<TestWall> FurnishedRoom() {
  std::vector<TestWall> all = TestBox(7, 7, {0, 0, 0});
  for (const TestWall& wall : TestBox(1.2, 0.5, {1.5, 3.2, 0})) all.push_back(wall);
  for (const TestWall& wall : TestBox(0.5, 0.9, {-3.2, -1, 0})) all.push_back(wall);
  for (const TestWall& wall : TestBox(0.8, 0.6, {-1, -3.2, 0})) all.push_back(wall);
  return all;
}

}  // namespace cairn::local_map
