#include "pipelines/landmark_map/refinement/along_odometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "pipelines/landmark_map/state/settings.h"
#include "pipelines/landmark_map/testing.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {
namespace {

constexpr std::size_t kPosts = 6;

// What the robot of PostsLog saw, whose odometry drifts by so much.
struct Posts {
  Blob blob;
  kinds::Log log;
  Settings settings;
  std::vector<RobotSteps> steps;

  explicit Posts(double drift_rad_per_m)
      : blob(PostsLog{.drift_rad_per_m = drift_rad_per_m}.Make()),
        log(Read<kinds::Log>(blob)),
        settings(Resolve(Options{}, blob)),
        steps{MakeSteps(log.robot[0], log.robots[0], settings.steps, nullptr)} {}

  FittedMap Along() const { return LaidAlongOdometry(log, steps, settings); }
  std::optional<FittedMap> BetterThan(const FittedMap& map) const {
    return BetterAlongOdometry(map, log, steps, settings);
  }
};

// One row of so many is of no landmark.
FittedMap WithoutRows(FittedMap map, std::size_t every) {
  for (std::size_t i = 0; i < map.rows[0].landmark.size(); i += every) map.rows[0].landmark[i] = -1;
  return map;
}

TEST(AlongOdometry, WhatGoodOdometryComesBackToIsThereOnceAndWhatABadOneDoesTwice) {
  const FittedMap along = Posts(0.0005).Along();
  EXPECT_EQ(along.refined.refused, "");
  EXPECT_EQ(along.landmarks.size(), kPosts);
  EXPECT_LT(RowsOfNone(along.rows), 5);
  EXPECT_GT(Posts(0.02).Along().landmarks.size(), kPosts);
}

TEST(AlongOdometry, EachRowOfNoneAndEachLandmarkCounts) {
  const FittedMap along = Posts(0.0005).Along();
  FittedMap other = WithoutRows(along, 4);
  other.landmarks.push_back(other.landmarks.front());
  const std::int64_t more = RowsOfNone(other.rows) - RowsOfNone(along.rows) + 1;
  EXPECT_GT(more, 50);
  EXPECT_NEAR(BehindOdometry(other, along).value(), kOfNoLandmark_nats * static_cast<double>(more), 1e-6);
  EXPECT_LT(BehindOdometry(along, other).value(), 0);
  other.refined.refused = kinds::kOdometryWrongByHalf;
  EXPECT_TRUE(std::isinf(BehindOdometry(other, along).value()));
  EXPECT_FALSE(BehindOdometry(along, other).has_value());
}

TEST(AlongOdometry, TakesThePlaceOfAMapThatExplainsLittle) {
  const Posts posts(0.0005);
  const FittedMap along = posts.Along();
  EXPECT_FALSE(posts.BetterThan(along));
  EXPECT_FALSE(posts.BetterThan(WithoutRows(along, 6))) << "less than a fifth";
  ASSERT_TRUE(posts.BetterThan(WithoutRows(along, 4)));
  EXPECT_EQ(posts.BetterThan(WithoutRows(along, 4))->landmarks.size(), kPosts);
  FittedMap refused = along;
  refused.refined.refused = "the least squares has no solution";
  EXPECT_FALSE(posts.BetterThan(refused)) << "EM's own may be right";
  refused.refined.refused = kinds::kOdometryWrongByHalf;
  ASSERT_TRUE(posts.BetterThan(refused));
  EXPECT_EQ(posts.BetterThan(refused)->refined.refused, "");
}

TEST(AlongOdometry, WhereNeitherHasASolutionNoLandmarkIsLeft) {
  Posts posts(0.0005);
  FittedMap refused = posts.Along();
  refused.refined.refused = kinds::kOdometryWrongByHalf;
  for (RobotSteps& steps : posts.steps) steps.observations.clear();
  std::ranges::fill(posts.steps[0].first_observation, 0);
  std::ranges::fill(posts.steps[0].row_observation, -1);
  const auto none = posts.BetterThan(refused);
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->landmarks.empty());
  EXPECT_TRUE(none->refined.landmarks.empty());
  EXPECT_EQ(RowsOfNone(none->rows), std::ssize(none->rows[0].landmark));
}

}  // namespace
}  // namespace cairn::landmark_map
