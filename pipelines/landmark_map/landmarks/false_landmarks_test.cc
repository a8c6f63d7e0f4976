#include "pipelines/landmark_map/landmarks/false_landmarks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn::landmark_map {
namespace {

constexpr Detection kTenthFalse{0.1, 0.05};

// 0.9/0.1 for a first contact detection; 0.95/0.02 for one more; 0.05 for each pass without.
TEST(LogOddsOfLandmark, IsBayesRule) {
  EXPECT_NEAR(LogOddsOfLandmark({1, 1}, kTenthFalse, 0.02), std::log(9.0), 1e-12);
  EXPECT_NEAR(LogOddsOfLandmark({4, 2}, kTenthFalse, 0.02), std::log(9.0 * 47.5 * 0.0025), 1e-12);
  EXPECT_NEAR(LogOddsOfLandmark({1, 3}, kTenthFalse, 0.02), std::log(9.0 * 47.5 * 47.5),
              1e-12);  // visits merged
}

// Along x past the origin and back at 1 m, then around at 2.5 m: leaving takes twice the reach.
TEST(CountVisits, EndBeyondTwiceTheReach) {
  const std::vector<double> x{-6, -1, 1, 6, 1, -6}, y{0, 0, 0, 0, 1, 1};
  EXPECT_EQ(CountVisits(x, y, 0, 0, 1.5), 2);
  const std::vector<double> near_x{-6, 0, 2.5, 0, 6}, near_y{0, 0, 0, 0, 0};
  EXPECT_EQ(CountVisits(near_x, near_y, 0, 0, 1.5), 1);
  EXPECT_EQ(CountVisits(x, y, 0, 20, 1.5), 0);
}

Landmark At(double x) { return {x, 0, {1, 0, 0, 1}, 0, 1}; }

// Four times along a corridor of 30 m. Landmark 0 at 5 m was detected four times, 1 at 12 m once, 2 at 20 m
// three times; 3 at 40 m, where the robot was once, once.
Blob Corridor() {
  std::vector<double> x, y;
  for (int lap = 0; lap < 4; ++lap) {
    for (int i = 0; i <= 60; ++i) x.push_back(lap % 2 == 0 ? 0.5 * i : 30 - 0.5 * i);
  }
  for (int i = 0; i <= 100; ++i) x.push_back(0.5 * i);
  y.assign(x.size(), 0.0);
  Blob result;
  result.Put("robots", Array::Texts({"rover"}));
  result.PutVector("robot/0/poses/x_m", x);
  result.PutVector("robot/0/poses/y_m", y);
  result.PutVector("robot/0/observations/map_landmark",
                   std::vector<std::int32_t>{0, 1, 2, 2, 0, 0, -1, 2, 2, 0, 0, 3});
  return result;
}

TEST(CountPasses, SaysHowOftenEachWasPassedAndObserved) {
  const std::vector<Passes> passes = CountPasses(Corridor(), {At(5), At(12), At(20), At(40)}, 1.5);
  ASSERT_EQ(passes.size(), 4U);
  EXPECT_EQ(passes[1].observed, 1);
  EXPECT_GT(passes[1].passed, 2) << "a false one, where the robot comes again and again";
  EXPECT_EQ(passes[0].passed, passes[0].observed);
}

TEST(AreLandmarks, ThoseThatArePassedWithoutAContactAreNone) {
  const std::vector<Landmark> landmarks{At(5), At(12), At(20), At(40)};
  EXPECT_EQ(AreLandmarks(Corridor(), landmarks, kTenthFalse, 1.5),
            (std::vector<bool>{true, false, true, true}));
  // A robot that sees half of what there is tells less.
  EXPECT_EQ(AreLandmarks(Corridor(), landmarks, {0.1, 0.7}, 1.5),
            (std::vector<bool>{true, true, true, true}));
}

TEST(KeepLandmarks, RenumbersTheAssociations) {
  std::vector<Landmark> landmarks{At(5), At(12), At(20), At(40)};
  Blob result = Corridor();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(8, 8);
  covariance(1, 4) = 7;  // y of the first with x of the third
  KeepLandmarks({true, false, true, false}, &landmarks, &covariance, &result);
  ASSERT_EQ(covariance.rows(), 4);
  EXPECT_EQ(covariance(1, 2), 7);
  ASSERT_EQ(landmarks.size(), 2U);
  EXPECT_EQ(landmarks[1].x_m, 20);
  const auto rows = result.Get<std::int32_t>("robot/0/observations/map_landmark");
  EXPECT_EQ(std::vector<std::int32_t>(rows.begin(), rows.end()),
            (std::vector<std::int32_t>{0, -1, 1, 1, 0, 0, -1, 1, 1, 0, 0, -1}));
}

}  // namespace
}  // namespace cairn::landmark_map
