#include "datasets/detect/posts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/detect/testing_scan.h"
#include "datasets/testing.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

const PostLimits kLimits{.least_m = 0.05, .most_m = 0.6, .reach_m = 30, .sigma_m = 0.03};

TEST(FindPosts, FindsTheMiddleOfARoundPost) {
  const ScanWorld world{{{5, 1, 0.15}}, {{8, -20, 8, 20}}};
  const auto posts = FindPosts(HalfTurn(), world.Scan(HalfTurn(), {}), kLimits);
  ASSERT_EQ(posts.size(), 1u);
  EXPECT_NEAR(posts[0].range_m, std::hypot(5, 1), 0.02);
  EXPECT_NEAR(posts[0].bearing_rad, std::atan2(1, 5), 0.002);
  EXPECT_NEAR(posts[0].radius_m, 0.15, 0.03);
  EXPECT_LT(posts[0].bearing_sigma_rad, HalfTurn().step_rad());
}

// The normalized square of what a post is off, of range and bearing, is 2 on average where the stated
// deviations are right; posts of all sizes that are looked for, wherever they are met by two beams and more.
TEST(FindPosts, StatesHowFarOffItIs) {
  Rng rng(7);
  double squares = 0, off_m = 0;
  int found = 0;
  constexpr int kPosts = 3000;
  for (int k = 0; k < kPosts; ++k) {
    const double range_m = rng.Uniform(2, 14), bearing = rng.Uniform(-1.4, 1.4);
    const ScanWorld world{
        {{range_m * std::cos(bearing), range_m * std::sin(bearing), rng.Uniform(0.05, 0.28)}}, {}};
    for (const Post& post : FindPosts(HalfTurn(), world.Scan(HalfTurn(), {}, 0.03, &rng), kLimits)) {
      ++found;
      off_m += post.range_m - range_m;
      squares += std::pow((post.range_m - range_m) / post.range_sigma_m, 2) +
                 std::pow(WrapAngle(post.bearing_rad - bearing) / post.bearing_sigma_rad, 2);
    }
  }
  EXPECT_GT(found, 0.97 * kPosts);
  EXPECT_LT(std::abs(off_m / found), 0.01);
  EXPECT_GT(squares / found, 1.5);
  EXPECT_LT(squares / found, 2.5);
}

TEST(FindPosts, WhatIsNoPost) {
  const auto count = [](const ScanWorld& world) {
    return FindPosts(HalfTurn(), world.Scan(HalfTurn(), {}), kLimits).size();
  };
  EXPECT_EQ(count({{{5, 1, 0.15}}, {}}), 1u);
  EXPECT_EQ(count({{{5, 1, 0.5}}, {}}), 0u) << "as wide as a car";
  EXPECT_EQ(count({{{5, 1, 0.15}}, {{5.2, -9, 5.2, 9}}}), 0u) << "close before a wall";
  EXPECT_EQ(count({{{5, 1, 0.15}}, {{3, -3, 3, 0.62}}}), 0u) << "partly hidden by a board";
  EXPECT_EQ(count({{{0.02, -5, 0.15}}, {}}), 0u) << "at the edge of what is seen";
  EXPECT_EQ(count({{}, {{5, -9, 5, 0}, {7, 0, 7, 9}}}), 0u) << "a wall's end";
  EXPECT_EQ(count({{{29.9, 0, 0.15}}, {}}), 0u) << "what is behind it is beyond the sensor's reach";
}

TEST(FindPosts, LooksAllRoundWhereTheSensorDoes) {
  const BeamFan fan = FanOf(720, -std::numbers::pi, std::numbers::pi / 360);
  const ScanWorld world{{{-4, 0, 0.2}}, {}};
  const auto posts = FindPosts(fan, world.Scan(fan, {}), kLimits);
  ASSERT_EQ(posts.size(), 1u);
  EXPECT_NEAR(std::abs(WrapAngle(posts[0].bearing_rad)), std::numbers::pi, 0.003);
}

TEST(FindPosts, BeamsMayGoEitherWay) {
  std::vector<double> zero(361), angle;
  for (int i = 0; i < 361; ++i) angle.push_back((180 - i) * std::numbers::pi / 360);
  const BeamFan fan(zero, zero, angle);
  EXPECT_LT(fan.angle_rad(0), fan.angle_rad(1));
  const std::vector<double> stored = {1, 2, 3};
  EXPECT_EQ(fan.Ordered(stored), (std::vector<double>{3, 2, 1}));
}

TEST(BeamFan, WhatIsNoFan) {
  const std::vector<double> zero(4), apart = {0, 0.1, 0, 0};
  const auto wrong = [&](const std::vector<double>& x_m, const std::vector<double>& angle) {
    return InputErrorOf([&] { BeamFan(x_m, zero, angle); });
  };
  EXPECT_EQ(wrong(zero, {-0.3, -0.1, 0.1, 0.3}), "");
  ExpectContains(wrong(apart, {-0.3, -0.1, 0.1, 0.3}), "several places");
  ExpectContains(wrong(zero, {-0.3, 0.1, -0.1, 0.3}), "one beside the other");
  ExpectContains(wrong(zero, {0, 2.8, 5.6, 8.4}), "more than a turn");
}

// A wall whose echo gets weaker with the distance, and a board on it.
TEST(FindReflectors, FindsWhatIsBrighterThanElseAtItsDistance) {
  const ScanWorld world{{}, {{6, -20, 6, 20}}};
  const std::vector<double> range_m = world.Scan(HalfTurn(), {});
  const auto wall = [&](std::size_t i) { return 100 / range_m[i]; };
  Brightness brightness;
  std::vector<double> intensity;
  for (std::size_t i = 0; i < range_m.size(); ++i) {
    const double y_m = range_m[i] * std::sin(HalfTurn().angle_rad(i));
    intensity.push_back(std::abs(y_m - 2) < 0.1 ? 5 * wall(i) : wall(i));
  }
  for (int scan = 0; scan < 100; ++scan)
    for (std::size_t i = 0; i < range_m.size(); ++i)
      brightness.Add(range_m[i], static_cast<float>(intensity[i]));
  brightness.Finish();
  EXPECT_LT(brightness.LeastOfReflectors(20), 100.0 / 6) << "what is far off is darker";
  const PostLimits limits{.least_m = 0.05, .most_m = 0.4, .reach_m = 30, .sigma_m = 0.03};
  const auto found = FindReflectors(HalfTurn(), range_m, intensity, brightness, limits);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].range_m * std::sin(found[0].bearing_rad), 2, 0.05);
  EXPECT_NEAR(found[0].range_m * std::cos(found[0].bearing_rad), 6, 0.05);
  const PostLimits narrow{.least_m = 0.01, .most_m = 0.05, .reach_m = 30, .sigma_m = 0.03};
  EXPECT_TRUE(FindReflectors(HalfTurn(), range_m, intensity, brightness, narrow).empty());
}

// Drivers that know no intensities write zeros.
TEST(Brightness, WhereAllIsDarkNothingIsAReflector) {
  Brightness brightness;
  for (int i = 0; i < 1000; ++i) brightness.Add(0.01 * i, 0);
  brightness.Finish();
  for (const double range_m : {0.0, 5.0, 50.0})
    EXPECT_EQ(brightness.LeastOfReflectors(range_m), std::numeric_limits<double>::infinity()) << range_m;
}

}  // namespace
}  // namespace cairn::datasets
