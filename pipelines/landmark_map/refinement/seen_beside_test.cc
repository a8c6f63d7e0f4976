#include "pipelines/landmark_map/refinement/seen_beside.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace cairn::landmark_map {
namespace {

constexpr double kQuarter = std::numbers::pi / 2, kForever_s = std::numeric_limits<double>::infinity();
constexpr double kContact = std::numeric_limits<double>::quiet_NaN();

// Two robots; the second goes 20 m ahead in as many seconds and sees, a metre to its left, the landmark 5 at
// 2 s and 4 s, presses the button 1 at 6 s, and sees the landmark 7, which the first knows, at 10 s: there
// its steps begin, and EM says that it is at (5, 7) and looks along y.
class AddSeenBesideTest : public ::testing::Test {
 protected:
  AddSeenBesideTest() : paths_(2) {
    log_.robots = std::vector<std::string>{"first", "second"};
    log_.robot.resize(2);
    kinds::Log::Robot& second = log_.robot[1];
    std::vector<double> time_s, turn_rad(21, 0.0), forward_m(21, 1.0);
    for (int t = 0; t <= 20; ++t) time_s.push_back(t);
    forward_m[0] = 0;
    second.odometry.time_s = time_s;
    second.odometry.turn_rad = turn_rad;
    second.odometry.forward_m = forward_m;
    second.observations.time_s = std::vector<double>{2, 3, 4, 6, 10};
    second.observations.range_m = std::vector<double>{1, 2, 1, kContact, 1};
    second.observations.bearing_rad = std::vector<double>{kQuarter, 0, kQuarter, kContact, kQuarter};
    second.observations.landmark = std::vector<std::int32_t>{5, -1, 5, 1, 7};
    AssociatedPath& path = paths_[1];
    path.steps.time_s = {10, 20};
    path.steps.odo_heading_rad = {0, 0};
    path.steps.row_observation = {-1, -1, -1, -1, 0};
    log_.robot[0].odometry = second.odometry;
    log_.robot[0].observations.time_s = std::vector<double>();
    log_.robot[0].observations.range_m = std::vector<double>();
    log_.robot[0].observations.bearing_rad = std::vector<double>();
    log_.robot[0].observations.landmark = std::vector<std::int32_t>();
    paths_[0].steps.time_s = {0};
    path.x_m = {5, 5};
    path.y_m = {7, 17};
    path.correction_rad = {kQuarter, kQuarter};
    landmarks_ = {{0, 0, {1, 0, 0, 1}, 3, 9}, {4, 7, {1, 0, 0, 1}, 7, 9}};
    associated_ = {{{0, 1, -1}, {1, 1, 0}}, {{1}, {1}}};
  }

  kinds::Log log_;
  std::vector<AssociatedPath> paths_;
  std::vector<Landmark> landmarks_;
  std::vector<Associated> associated_;
};

TEST_F(AddSeenBesideTest, StandsWhereOdometryBackFromTheFirstStepSays) {
  AddSeenBeside(log_, paths_, kForever_s, &landmarks_, &associated_);
  ASSERT_EQ(landmarks_.size(), 4U);
  const std::vector<int> names{1, 3, 5, 7};
  for (std::size_t l = 0; l < names.size(); ++l) EXPECT_EQ(landmarks_[l].type, names[l]);
  EXPECT_NEAR(landmarks_[0].x_m, 5, 1e-9);
  EXPECT_NEAR(landmarks_[0].y_m, 3, 1e-9);
  EXPECT_EQ(landmarks_[0].count, 1);
  EXPECT_NEAR(landmarks_[2].x_m, 4, 1e-9);
  EXPECT_NEAR(landmarks_[2].y_m, 1, 1e-9) << "by the last row of it";
  EXPECT_EQ(landmarks_[2].count, 2);
  EXPECT_GT(landmarks_[2].covariance_m2[0], landmarks_[0].covariance_m2[0]) << "it is further back";
  EXPECT_EQ(associated_[0].landmark, (std::vector<std::int32_t>{1, 3, -1}));
  EXPECT_EQ(associated_[1].landmark, (std::vector<std::int32_t>{3}));
}

// Seen at 11 s and 14 s, between the steps at 10 s and 20 s, to the first of which EM has taken the row at 11
// s.
TEST_F(AddSeenBesideTest, StandsWhereOdometryFromTheStepBeforeSays) {
  kinds::Log::Observations& seen = log_.robot[1].observations;
  seen.time_s = std::vector<double>{10, 11, 14};
  seen.range_m = std::vector<double>{1, 2, 2};
  seen.bearing_rad = std::vector<double>{kQuarter, kQuarter, kQuarter};
  seen.landmark = std::vector<std::int32_t>{7, 9, 9};
  paths_[1].steps.row_observation = {0, 1, -1};
  associated_[1] = {{1, -1}, {1, 0}};
  AddSeenBeside(log_, paths_, kForever_s, &landmarks_, &associated_);
  ASSERT_EQ(landmarks_.size(), 3U);
  EXPECT_EQ(landmarks_[2].type, 9);
  EXPECT_NEAR(landmarks_[2].x_m, 3, 1e-9);
  EXPECT_NEAR(landmarks_[2].y_m, 8, 1e-9) << "by the row that is nearest to a step";
  EXPECT_EQ(landmarks_[2].count, 2);
  EXPECT_EQ(associated_[1].landmark, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(associated_[1].probability, (std::vector<double>{1, 1}));
}

TEST_F(AddSeenBesideTest, WhatIsInTheMapOrWithoutANameOrLaterIsLeftAlone) {
  log_.robot[1].observations.landmark = std::vector<std::int32_t>{7, -1, 3, -1, 7};
  const std::vector<Landmark> before = landmarks_;
  AddSeenBeside(log_, paths_, kForever_s, &landmarks_, &associated_);
  EXPECT_EQ(landmarks_.size(), before.size());
  log_.robot[1].observations.landmark = std::vector<std::int32_t>{7, -1, 5, 1, 7};
  AddSeenBeside(log_, paths_, 5.0, &landmarks_, &associated_);
  ASSERT_EQ(landmarks_.size(), 3U) << "the data end before the button";
  EXPECT_EQ(landmarks_[1].type, 5);
}

}  // namespace
}  // namespace cairn::landmark_map
