#include "pipelines/local_map/grids/ring.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pipelines/local_map/testing/room.h"

namespace cairn::local_map {
namespace {

const double kNone = std::nan("");

std::vector<Point> HitsOf(const SensorRing& ring, const Pose& robot, double turret_rad,
                          const std::vector<double>& ranges) {
  std::vector<Point> hits(ring.sectors());
  hits.resize(ring.Hits(robot, {0, turret_rad, ranges}, hits));
  return hits;
}

void ExpectAt(Point p, double x, double y) {
  EXPECT_NEAR(p.x_m, x, 1e-12);
  EXPECT_NEAR(p.y_m, y, 1e-12);
}

// Four rays from 0.2 m ahead of a turret that looks to the left of a robot that looks to the left: they point
// back, and then right of that.
TEST(SensorRing, TheTurretTurnsTheRingOnTheRobot) {
  const SensorRing ring(RingBeams(4, 0.2), 0, 5);
  const double quarter = std::numbers::pi / 2;
  const auto hits = HitsOf(ring, {1, 2, quarter}, quarter, {1, 2, 3, 4});
  ASSERT_EQ(hits.size(), 4U);
  ExpectAt(hits[0], 1 - 1.2, 2);
  ExpectAt(hits[1], 1, 2 - 2.2);
  ExpectAt(hits[2], 1 + 3.2, 2);
  ExpectAt(hits[3], 1, 2 + 4.2);
}

TEST(SensorRing, MissingSensorsGiveNoHits) {
  const SensorRing ring(RingBeams(4, 0), 0, 5);
  const auto hits = HitsOf(ring, {}, 0, {kNone, 2, 5.1, 0});
  ASSERT_EQ(hits.size(), 1U);
  EXPECT_EQ(HitsOf(ring, {}, 0, {5, 2, 4.999999, 4.99}).size(), 2U) << "at its reach it met nothing";
  ExpectAt(hits[0], 0, 2);
  EXPECT_TRUE(HitsOf(ring, {}, 0, {}).empty());
}

TEST(SensorRing, IsClosedWhereItsEndsAreNeighbours) {
  EXPECT_TRUE(SensorRing(RingBeams(24), 0, 5).closed());
  std::vector<Pose> half;
  for (int b = 0; b < 180; ++b) half.push_back({0, 0, (b - 90) * std::numbers::pi / 180});
  EXPECT_FALSE(SensorRing(half, 0, 80).closed());
}

TEST(SensorRing, ALaserIsThinnedToTheNearestOfEachSector) {
  std::vector<Pose> beams;
  for (int b = 0; b < 6; ++b) beams.push_back({0, 0, 0.1 * b});
  const SensorRing ring(beams, 0, 5, 3);
  EXPECT_EQ(ring.sectors(), 3U);
  const auto hits = HitsOf(ring, {}, 0, {2, 1, kNone, 3, 9, kNone});
  ASSERT_EQ(hits.size(), 2U);
  ExpectAt(hits[0], std::cos(0.1), std::sin(0.1));
  ExpectAt(hits[1], 3 * std::cos(0.3), 3 * std::sin(0.3));
}

// A wall 1.5 m to the left of a robot that stands at every angle to it.
TEST(SensorRing, EchoesOfAWallLieOnIt) {
  const std::vector<TestWall> wall{{{-20, 1.5}, {20, 1.5}}};
  const SensorRing cones(RingBeams(), kTestOpeningRad, 6), rays(RingBeams(), 0, 6);
  int count = 0;
  double worst = 0, worst_on_axes = 0;
  for (int k = 0; k < 15; ++k) {
    const Pose robot{0, 0, RadOf(k)};
    std::vector<double> ranges;
    for (const Pose& beam : RingBeams()) {
      const double range = InConeM(wall, Compose(robot, beam), kTestOpeningRad / 2);
      ranges.push_back(range < 3 ? range : kNone);
    }
    for (const Point& hit : HitsOf(cones, robot, 0, ranges)) {
      ++count;
      worst = std::max(worst, std::abs(hit.y_m - 1.5));
    }
    for (const Point& hit : HitsOf(rays, robot, 0, ranges))
      worst_on_axes = std::max(worst_on_axes, std::abs(hit.y_m - 1.5));
  }
  EXPECT_GT(count, 15 * 7);
  EXPECT_LT(worst, 0.05);
  EXPECT_GT(worst_on_axes, 0.25);  // what is won
}

TEST(SensorRing, AnEchoWithoutNeighboursLiesOnTheAxis) {
  const SensorRing ring(RingBeams(24, 0), kTestOpeningRad, 6);
  std::vector<double> ranges(24, kNone);
  ranges[6] = 2;
  ranges[7] = 5;  // another surface
  ExpectAt(HitsOf(ring, {}, 0, ranges)[0], 0, 2);
}

}  // namespace
}  // namespace cairn::local_map
