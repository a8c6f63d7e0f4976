#include "pipelines/landmark_map/refinement/sensor_shift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

// A robot of 1 m/s whose sensor's clock is `late_s` late, through the pipeline.
BlobPtr MapOfLate(const PostsLog& posts, double late_s) {
  Blob log = posts.Make();
  const auto time = log.Get<double>("robot/0/observations/time_s");
  std::vector<double> late(time.begin(), time.end());
  for (double& time_s : late) time_s += late_s;
  log.PutVector("robot/0/observations/time_s", late);
  return RunInProcess(LandmarkMap({}), {{"log", std::make_shared<const Blob>(log)}});
}

TEST(FindSensorShifts, FindByHowMuchAndWhichIsLate) {
  for (const bool named : {true, false}) {
    for (const double late_s : {0.8, 0.4, -0.4, -0.9}) {
      const BlobPtr map = MapOfLate({.drift_rad_per_m = 0.002, .named = named}, late_s);
      ASSERT_TRUE(map->Has("robot/0/observations_late_s")) << named << ", " << late_s;
      EXPECT_NEAR(map->Scalar<double>("robot/0/observations_late_s"), late_s, 0.1) << named;
    }
  }
}

TEST(FindSensorShifts, FindByHowMuchASensorIsTurned) {
  for (const bool named : {true, false}) {
    for (const double turned_rad : {0.1, -0.05}) {
      Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = named}.Make();
      const auto before = log.Get<double>("robot/0/observations/bearing_rad");
      std::vector<double> bearing(before.begin(), before.end());
      for (double& rad : bearing) rad += turned_rad;
      log.PutVector("robot/0/observations/bearing_rad", bearing);
      const BlobPtr map = RunInProcess(LandmarkMap({}), {{"log", std::make_shared<const Blob>(log)}});
      ASSERT_TRUE(map->Has("robot/0/bearings_turned_rad")) << named << ", " << turned_rad;
      EXPECT_NEAR(map->Scalar<double>("robot/0/bearings_turned_rad"), turned_rad, 0.01) << named;
      EXPECT_FALSE(map->Has("robot/0/observations_late_s"));
    }
  }
}

// Half a metre ahead, or behind, to the side, and turned besides.
TEST(FindSensorShifts, FindWhereASensorSits) {
  for (const bool named : {true, false}) {
    for (const Pose& mount : {Pose{0.5, 0, 0}, Pose{-0.4, 0.1, 0}, Pose{0.3, 0, 0.14}}) {
      Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = named}.Make();
      const auto range = log.Get<double>("robot/0/observations/range_m"),
                 bearing = log.Get<double>("robot/0/observations/bearing_rad");
      std::vector<double> seen_range, seen_bearing;
      for (std::size_t i = 0; i < range.size(); ++i) {
        const Pose at = Between(mount, {range[i] * std::cos(bearing[i]), range[i] * std::sin(bearing[i]), 0});
        seen_range.push_back(std::hypot(at.x_m, at.y_m));
        seen_bearing.push_back(std::atan2(at.y_m, at.x_m));
      }
      log.PutVector("robot/0/observations/range_m", seen_range);
      log.PutVector("robot/0/observations/bearing_rad", seen_bearing);
      const BlobPtr map = RunInProcess(LandmarkMap({}), {{"log", std::make_shared<const Blob>(log)}});
      ASSERT_TRUE(map->Has("robot/0/sensor_x_m")) << named << ", " << mount.x_m;
      EXPECT_NEAR(map->Scalar<double>("robot/0/sensor_x_m"), mount.x_m, 0.1) << named;
      EXPECT_NEAR(map->Scalar<double>("robot/0/sensor_y_m"), mount.y_m, 0.1) << named;
      EXPECT_NEAR(map->Scalar<double>("robot/0/bearings_turned_rad"), -mount.heading_rad, 0.03) << named;
      EXPECT_FALSE(map->Has("robot/0/observations_late_s"));
    }
  }
}

TEST(FindSensorShifts, NoneWhereClocksAgreeAndBearingsAreRight) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    for (const bool named : {true, false}) {
      const BlobPtr map = MapOfLate({.drift_rad_per_m = 0.01, .seed = seed, .named = named}, 0.0);
      EXPECT_FALSE(map->Has("robot/0/observations_late_s")) << seed << ", " << named;
      EXPECT_FALSE(map->Has("robot/0/bearings_turned_rad")) << seed << ", " << named;
      EXPECT_FALSE(map->Has("robot/0/sensor_x_m")) << seed << ", " << named;
    }
  }
}

}  // namespace
}  // namespace cairn::landmark_map
