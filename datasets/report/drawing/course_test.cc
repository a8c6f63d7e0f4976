#include "datasets/report/drawing/course.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn::datasets::report {
namespace {

constexpr double kTolerance = 0.03;

// A walk that turns and changes its speed, and stands still for a while.
struct Walk {
  std::vector<Point> points;
  std::vector<double> times_s;
};
Walk MakeWalk() {
  Walk walk;
  Point at{0, 0};
  for (int i = 0; i < 5000; ++i) {
    walk.points.push_back(at);
    walk.times_s.push_back(0.1 * i + (i > 2500 ? 60 : 0));
    const double heading = std::sin(0.004 * i) * 3,
                 step = i % 1000 < 200 ? 0 : 0.2 + 0.15 * std::sin(0.02 * i);
    at = {at.x_m + step * std::cos(heading), at.y_m + step * std::sin(heading)};
  }
  return walk;
}

TEST(Course, IsWhereSomebodyWhoFollowsItIsAtEachTime) {
  const Walk walk = MakeWalk();
  const std::vector<std::size_t> course = CourseOf(walk.points, walk.times_s, kTolerance);
  EXPECT_LT(course.size(), walk.points.size() / 2);
  for (std::size_t k = 1; k < course.size(); ++k) {
    const std::size_t a = course[k - 1], b = course[k];
    for (std::size_t i = a; i <= b; ++i) {
      const double share = (walk.times_s[i] - walk.times_s[a]) / (walk.times_s[b] - walk.times_s[a]);
      const Point there{walk.points[a].x_m + share * (walk.points[b].x_m - walk.points[a].x_m),
                        walk.points[a].y_m + share * (walk.points[b].y_m - walk.points[a].y_m)};
      ASSERT_LE(DistanceM(there, walk.points[i]), kTolerance + 1e-9) << i;
    }
  }
}

TEST(Course, WithoutTimesKeepsTheLineAlone) {
  const Walk walk = MakeWalk();
  EXPECT_LT(CourseOf(walk.points, {}, kTolerance).size(),
            CourseOf(walk.points, walk.times_s, kTolerance).size());
  const std::vector<Point> there_and_back{{0, 0}, {5, 0}, {10, 0}, {4, 0}, {2, 0}};
  EXPECT_EQ(CourseOf(there_and_back, {}, kTolerance), (std::vector<std::size_t>{0, 2, 4}));
}

TEST(Course, OfFewPointsIsAllOfThem) {
  EXPECT_TRUE(CourseOf({}, {}, kTolerance).empty());
  EXPECT_EQ(CourseOf(std::vector<Point>{{1, 1}}, {}, kTolerance).size(), 1u);
  EXPECT_EQ(CourseOf(std::vector<Point>{{1, 1}, {1, 1}}, std::vector<double>{0, 0}, kTolerance).size(), 2u);
}

}  // namespace
}  // namespace cairn::datasets::report
