#include "datasets/evaluate/reference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/error.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

TEST(ReferencePoint, IsReadOrRefused) {
  EXPECT_TRUE(ReferencePoint::Parse("estimate").estimated);
  const ReferencePoint stated = ReferencePoint::Parse("0.06,-0.01");
  EXPECT_FALSE(stated.estimated);
  EXPECT_EQ(stated.at.x_m, 0.06);
  EXPECT_EQ(stated.at.y_m, -0.01);
  for (const char* wrong : {"", "0.06", "0.06,", ",1", "a,b", "1,2,3", "nan,0", "1,inf"})
    EXPECT_THROW(ReferencePoint::Parse(wrong), InputError) << wrong;
}

// Paths whose truth is of `point` of each robot, in a frame that is `frame` of the map's.
std::vector<PosesAndPositions> PathsOf(const std::vector<Point>& point, const Similarity& frame, double off_m,
                                       bool turns = true, int poses = 60) {
  Rng rng(7);
  std::vector<PosesAndPositions> robots;
  for (const Point& at : point) {
    PosesAndPositions& path = robots.emplace_back();
    for (int i = 0; i < poses; ++i) {
      const Pose pose{5 * rng.Normal(), 3 * rng.Normal(), turns ? 2 * rng.Normal() : 0.4};
      const Pose seen = Compose(pose, {at.x_m, at.y_m, 0});
      path.push_back({pose, frame(Point{seen.x_m + off_m * rng.Normal(), seen.y_m + off_m * rng.Normal()})});
    }
  }
  return robots;
}

TEST(FitReference, FindsEachRobotsPointAndTheFrame) {
  const Similarity frame{1.12, 2.5, 400, -30};
  const std::vector<Point> point{{0.06, 0.01}, {-0.2, 0.3}};
  for (const double off_m : {0.0, 0.02}) {
    const auto found = FitReference(PathsOf(point, frame, off_m));
    ASSERT_TRUE(found);
    const Similarity back = Inverse(frame);
    EXPECT_NEAR(found->to_map.scale, back.scale, 1e-9 + off_m / 10);
    EXPECT_NEAR(WrapAngle(found->to_map.angle_rad - back.angle_rad), 0, 1e-9 + off_m / 10);
    const Point there = found->to_map(frame(Point{1, 2}));
    EXPECT_NEAR(there.x_m, 1, 1e-9 + off_m);
    EXPECT_NEAR(there.y_m, 2, 1e-9 + off_m);
    ASSERT_EQ(found->point.size(), 2U);
    for (std::size_t r = 0; r < 2; ++r) {
      EXPECT_NEAR(found->point[r].x_m, point[r].x_m, 1e-9 + off_m / 2);
      EXPECT_NEAR(found->point[r].y_m, point[r].y_m, 1e-9 + off_m / 2);
    }
    EXPECT_NEAR(found->rmse_m, std::sqrt(2) * off_m, 1e-9 + off_m / 5);
  }
}

TEST(FitReference, LeavesOutARobotWithoutTruth) {
  std::vector<PosesAndPositions> robots = PathsOf({{0.1, 0}, {0, 0.1}}, {}, 0);
  robots[0].clear();
  const auto found = FitReference(robots);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->point[0].x_m, 0);
  EXPECT_NEAR(found->point[1].y_m, 0.1, 1e-9);
}

TEST(FitReference, IsNoneWhereThePosesDoNotTellIt) {
  EXPECT_FALSE(FitReference({}));
  EXPECT_FALSE(FitReference(PathsOf({{0.1, 0}}, {}, 0, true, 3)));
  EXPECT_TRUE(FitReference(PathsOf({{0.1, 0}}, {}, 0, true, 4)));
  EXPECT_FALSE(FitReference(PathsOf({{0.1, 0}}, {}, 0.01, false)));
}

}  // namespace
}  // namespace cairn::datasets
