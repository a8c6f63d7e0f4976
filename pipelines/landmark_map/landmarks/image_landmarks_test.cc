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
  AppendImages(steps, 0, 4, {0.0, 10.0}, {0.0, 20.0}, {0.0, std::numbers::pi / 2}, {}, &images);
  ASSERT_EQ(images.size(), 1U);  // the first observation is a contact detection
  EXPECT_EQ(images[0].robot, 4U);
  EXPECT_NEAR(images[0].heading_rad, std::numbers::pi, 1e-12);
  EXPECT_EQ(images[0].observation, (std::vector<std::int32_t>{2}));
  ASSERT_EQ(images[0].seen.size(), 1U);
  EXPECT_NEAR(images[0].seen[0].x_m, 7.0, 1e-12);
  EXPECT_NEAR(images[0].seen[0].y_m, 20.0, 1e-12);
}

// The first of the triplet has a name, which every other image gives; so it is there once, and what stands
// 0.2 m beside it stays.
TEST(FindImageLandmarks, ANameNowAndThenMakesNoDouble) {
  std::vector<ImageObservations> images = ImagesOf(kTriplet, 60);
  for (std::size_t i = 0; i < images.size(); i += 2) {
    images[i].named.push_back({0, images[i].seen[0], true});
    images[i].seen.erase(images[i].seen.begin());
  }
  const ImageLandmarks found = FindImageLandmarks(images, {kSigmaM, 0.05, 1}, {kTriplet[0]});
  ASSERT_EQ(found.landmarks.size(), 2U);
  for (std::size_t k = 1; k < 3; ++k) EXPECT_LT(ToNearest(kTriplet[k], found.landmarks), 0.06);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::multiset<std::int32_t> given(found.landmark[i].begin(), found.landmark[i].end());
    EXPECT_EQ(given,
              i % 2 == 0 ? (std::multiset<std::int32_t>{1, 2}) : (std::multiset<std::int32_t>{0, 1, 2}));
  }
}

// In one image of four a false one, anywhere among the landmarks: some lie together. One more landmark that
// is seen in four images only is one, where nothing is false.
TEST(FindImageLandmarks, FalseObservationsThatFellTogetherAreNoLandmarks) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
    Rng rng(seed);
    std::vector<ImageObservations> clean = ImagesOf({{-1.5, -1.5}, {1.5, -1.5}, {-1.5, 1.5}, {1.5, 1.5}}, 40);
    std::vector<ImageObservations> cluttered = clean;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      if (i % 4 == 0) cluttered[i].seen.push_back({rng.Uniform(-1, 1), rng.Uniform(-1, 1)});
      if (i % 10 == 0) clean[i].seen.push_back({0.0, 0.0});
    }
    EXPECT_EQ(FindImageLandmarks(clean, {kSigmaM, 0.05, 0}).landmarks.size(), 5U);
    EXPECT_EQ(FindImageLandmarks(cluttered, {kSigmaM, 0.05, 0}).landmarks.size(), 4U) << seed;
  }
}

// What comes by, without a name, while the same sensor names what stands there; where a sensor of its own, in
// images of its own, shows what has no name, those that show names alone say nothing of it.
TEST(FindImageLandmarks, ImagesThatShowNamesAloneLookedThereTooWhereTheSensorIsTheSame) {
  for (const bool same_sensor : {true, false}) {
    std::vector<ImageObservations> images = ImagesOf({{1.0, 0.0}}, 120);
    for (std::size_t i = 0; i < images.size(); ++i) {
      const bool comes_by = i % 30 == 0;
      images[i].named = {{0, images[i].seen[0], same_sensor || !comes_by}};
      images[i].seen.clear();
      if (comes_by) images[i].seen = {{0.0, -0.5}};
    }
    EXPECT_EQ(FindImageLandmarks(images, {kSigmaM, 0.05, 1}, {{1.0, 0.0}}).landmarks.size(),
              same_sensor ? 0U : 1U);
  }
}

// Named a little earlier, the landmark may be what this image shows without a name.
TEST(FindImageLandmarks, ANameOfAnotherImageTakesNothing) {
  std::vector<ImageObservations> images = ImagesOf({kTriplet[0]}, 60);
  for (const bool shown : {false, true}) {
    for (ImageObservations& image : images) image.named = {{0, image.seen[0], shown}};
    const ImageLandmarks found = FindImageLandmarks(images, {kSigmaM, 0.05, 1}, {kTriplet[0]});
    EXPECT_EQ(found.landmarks.size(), shown ? 1U : 0U);
    EXPECT_EQ(found.landmark[0], (std::vector<std::int32_t>{shown ? 1 : 0}));
  }
}

// Two rows are one observation of the landmark that has a name; the first of them was made with the one that
// has none.
TEST(AppendImages, SaysWhichNamesTheImageShows) {
  RobotSteps steps;
  steps.time_s = {0.0};
  steps.odo_heading_rad = {0.0};
  steps.first_observation = {0, 3};
  steps.observations = {{0, 2.0, 0.0}, {1, 3.0, 0.0}, {2, 4.0, 0.0}};
  steps.row_observation = {0, 2, 0, 1};
  const std::vector<double> row_time_s = {5.0, 5.0, 6.0, 6.5};
  std::vector<ImageObservations> images;
  AppendImages(steps, 2, 0, {10.0}, {0.0}, {0.0}, row_time_s, &images);
  ASSERT_EQ(images.size(), 1U);
  EXPECT_EQ(images[0].observation, (std::vector<std::int32_t>{2}));
  ASSERT_EQ(images[0].named.size(), 2U);
  EXPECT_TRUE(images[0].named[0].shown);
  EXPECT_DOUBLE_EQ(images[0].named[0].position.x_m, 12.0);
  EXPECT_EQ(images[0].named[1].landmark, 1);
  EXPECT_FALSE(images[0].named[1].shown);
}

}  // namespace
}  // namespace cairn::landmark_map
