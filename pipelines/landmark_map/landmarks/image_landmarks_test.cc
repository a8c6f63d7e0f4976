#include "pipelines/landmark_map/landmarks/image_landmarks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "schema/rng.h"

namespace cairn::landmark_map {
namespace {

constexpr double kObservationM = 0.05, kPoseM = 0.15, kSigmaM = 0.16;
const std::vector<Point> kTriplet = {{0.0, 0.0}, {0.2, 0.0}, {0.1, 0.2}};

// Images from a ring of 3 m around the places, each with its own error of the pose.
std::vector<ImageObservations> ImagesOf(const std::vector<Point>& positions, int count) {
  Rng rng(7);
  std::vector<ImageObservations> images;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    ImageObservations image{
        {3.0 * std::cos(angle), 3.0 * std::sin(angle)}, angle + std::numbers::pi, {}, 0, {}};
    const double dx = kPoseM * rng.Normal(), dy = kPoseM * rng.Normal();
    for (const Point& p : positions) {
      image.seen.push_back(
          {p.x_m + dx + kObservationM * rng.Normal(), p.y_m + dy + kObservationM * rng.Normal()});
    }
    images.push_back(image);
  }
  return images;
}

double ToNearest(const Point& position, const std::vector<Landmark>& landmarks) {
  double nearest = 1e9;
  for (const Landmark& l : landmarks) {
    nearest = std::min(nearest, std::hypot(l.x_m - position.x_m, l.y_m - position.y_m));
  }
  return nearest;
}

TEST(FindImageLandmarks, TellsApartWhatStandsCloserThanAPoseIsExact) {
  const ImageLandmarks found = FindImageLandmarks(ImagesOf(kTriplet, 60), {kSigmaM, 0.05, 0});
  ASSERT_EQ(found.landmarks.size(), 3U);
  for (const Point& p : kTriplet) EXPECT_LT(ToNearest(p, found.landmarks), 0.06);
  for (const Landmark& l : found.landmarks) EXPECT_GE(l.count, 50.0);
}

TEST(FindImageLandmarks, AnImageShowsNoLandmarkTwice) {
  const ImageLandmarks found = FindImageLandmarks(ImagesOf(kTriplet, 60), {kSigmaM, 0.05, 0});
  ASSERT_EQ(found.landmark.size(), 60U);
  for (const auto& image : found.landmark) {
    ASSERT_EQ(image.size(), 3U);
    std::set<std::int32_t> given;
    for (const std::int32_t k : image) {
      if (k >= 0) {
        EXPECT_TRUE(given.insert(k).second);
      }
    }
  }
}

// A robot that comes by stands in the view of all images and is seen in few of them.
TEST(FindImageLandmarks, WhatFewOfTheImagesThatLookedThereShowIsNone) {
  std::vector<ImageObservations> images = ImagesOf({{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.5}}, 60);
  for (int i = 0; i < 4; ++i) images[static_cast<std::size_t>(i)].seen.push_back({0.0, -0.5});
  const ImageLandmarks found = FindImageLandmarks(images, {kSigmaM, 0.05, 2});
  ASSERT_EQ(found.landmarks.size(), 3U);
  EXPECT_EQ(found.landmarks[0].type, 2);
  EXPECT_EQ(found.landmark[0].back(), -1);
}

TEST(FindImageLandmarks, OfNoImagesThereIsNothing) {
  EXPECT_TRUE(FindImageLandmarks({}, {kSigmaM, 0.05, 0}).landmarks.empty());
}

// Odometry looks along y, the robot has turned a quarter further: what odometry has ahead stands along -x.
TEST(AppendImages, LaysObservationsOutFromThePose) {
  RobotSteps steps;
  steps.time_s = {0.0, 1.0};
  steps.odo_heading_rad = {0.0, std::numbers::pi / 2};
  steps.first_observation = {0, 1, 3};
  steps.observations = {{0, 0.0, 0.0}, {1, 0.0, 2.0}, {0, 0.0, 3.0}};
  std::vector<ImageObservations> images;
  AppendImages(steps, 0, 4, {0.0, 10.0}, {0.0, 20.0}, {0.0, std::numbers::pi / 2}, &images);
  ASSERT_EQ(images.size(), 1U);  // the first observation is a contact detection
  EXPECT_EQ(images[0].robot, 4U);
  EXPECT_NEAR(images[0].heading_rad, std::numbers::pi, 1e-12);
  EXPECT_EQ(images[0].observation, (std::vector<std::int32_t>{2}));
  ASSERT_EQ(images[0].seen.size(), 1U);
  EXPECT_NEAR(images[0].seen[0].x_m, 7.0, 1e-12);
  EXPECT_NEAR(images[0].seen[0].y_m, 20.0, 1e-12);
}

}  // namespace
}  // namespace cairn::landmark_map
