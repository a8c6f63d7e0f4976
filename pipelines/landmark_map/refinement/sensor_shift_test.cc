#include "pipelines/landmark_map/refinement/sensor_shift.h"

#include <gtest/gtest.h>

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

TEST(FindSensorShifts, NoneWhereClocksAgreeAndBearingsAreRight) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    for (const bool named : {true, false}) {
      const BlobPtr map = MapOfLate({.drift_rad_per_m = 0.01, .seed = seed, .named = named}, 0.0);
      EXPECT_FALSE(map->Has("robot/0/observations_late_s")) << seed << ", " << named;
      EXPECT_FALSE(map->Has("robot/0/bearings_turned_rad")) << seed << ", " << named;
    }
  }
}

}  // namespace
}  // namespace cairn::landmark_map
