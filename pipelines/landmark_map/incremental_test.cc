#include "pipelines/landmark_map/incremental.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_map {
namespace {

BlobPtr IncrementalMap(const Blob& log, const Options& options) {
  return RunInProcess(LandmarkMap(options), {{"log", std::make_shared<const Blob>(log)}});
}

Options Incremental(std::int64_t observations = 0) {
  return {.cell_m = 1.0, .prefix_observations = observations, .incremental = true};
}

// How many of the poses of the first five corners are, to the bit, those of a log that ends there.
std::size_t PosesThatStay(const Blob& log, Options options) {
  constexpr std::int64_t kObservations = 5;
  const BlobPtr whole = IncrementalMap(log, options);
  options.prefix_observations = kObservations;
  const BlobPtr part = IncrementalMap(log, options);
  const double until_s = log.Get<double>("robot/0/observations/time_s")[kObservations - 1];
  const auto time_s = part->Get<double>("robot/0/poses/time_s");
  std::size_t same = 0;
  for (std::size_t i = 0; i < time_s.size() && time_s[i] <= until_s; ++i) {
    bool all = true;
    for (const char* column : {"time_s", "x_m", "y_m", "heading_rad", "mode_x_m", "mode_y_m"}) {
      const std::string name = std::string("robot/0/poses/") + column;
      all = all && part->Get<double>(name)[i] == whole->Get<double>(name)[i];
    }
    same += all ? 1 : 0;
  }
  return same;
}

TEST(Incremental, WhatWasFoundIsNeverRevised) {
  const Blob log = SquareLog{.laps = 3, .side_m = 20.0, .walk_rad_per_sqrt_m = 0.02}.Make();
  EXPECT_GT(PosesThatStay(log, Incremental()), 90U);
  // EM without beta goes on over all data: its poses owe their map to what came later.
  EXPECT_LT(PosesThatStay(log, {.cell_m = 1.0, .revise = false, .starts = 1}), 10U);
}

// A data sheet that says as much.
Blob WithGoodOdometry(SquareLog log) {
  log.walk_rad_per_sqrt_m = 0.002;
  Blob blob = log.Make();
  blob.PutScalar("noise/heading_drift_rad_per_m", 1e-5);
  blob.PutScalar("noise/heading_walk_rad_per_sqrt_m", 0.002);
  blob.PutScalar("noise/turn_ratio", 0.002);
  return blob;
}

TEST(Incremental, FindsTheCornersOfASquareWhereOdometryIsGood) {
  const BlobPtr result = IncrementalMap(WithGoodOdometry({.laps = 3, .side_m = 20.0}), Incremental());
  const auto x = result->Get<double>("map/landmark_x_m"), y = result->Get<double>("map/landmark_y_m");
  ASSERT_EQ(x.size(), 4U);
  for (const auto& [corner_x, corner_y] : {std::pair(20.0, 0.0), {20.0, 20.0}, {0.0, 20.0}, {0.0, 0.0}}) {
    double nearest = 1e9;
    for (std::size_t k = 0; k < 4; ++k)
      nearest = std::min(nearest, std::hypot(x[k] - corner_x, y[k] - corner_y));
    EXPECT_LT(nearest, 1.5);
  }
  const auto landmark = result->Get<std::int32_t>("robot/0/observations/map_landmark");
  ASSERT_EQ(landmark.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(landmark[i], landmark[i % 4]) << i;
  EXPECT_EQ(std::set<std::int32_t>(landmark.begin(), landmark.end()).size(), 4U);
  EXPECT_EQ(result->at("history/log_likelihood").size(), 1);
  EXPECT_FALSE(result->Has("search/support")) << "there was no search";
}

TEST(Incremental, TakesRangesAndBearings) {
  const BlobPtr result = IncrementalMap(
      WithGoodOdometry({.laps = 2, .side_m = 20.0, .ranged = true, .identified = true}), Incremental());
  EXPECT_EQ(result->at("map/landmark_x_m").size(), 4);
}

TEST(Incremental, RefusesWhatOnePassCannotTake) {
  const auto complaint = [](const Blob& log, const Options& options, bool with_map) -> std::string {
    std::map<std::string, BlobPtr> inputs{{"log", std::make_shared<const Blob>(log)}};
    if (with_map) inputs["map"] = IncrementalMap(log, {.cell_m = 1.0, .starts = 1});
    try {
      RunInProcess(LandmarkMap(options), inputs);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const Blob log = SquareLog{.laps = 2, .side_m = 20.0}.Make();
  Options exact = Incremental();
  exact.model = "exact";
  EXPECT_NE(complaint(log, exact, false).find("model exact rules out"), std::string::npos);
  EXPECT_NE(complaint(log, Incremental(), true).find("a map of its own"), std::string::npos);
  Blob two = log;
  two.Put("robots", Array::Texts({"a", "b"}));
  two.PutAll("robot/1/", log.Sub("robot/0/"));
  EXPECT_NE(complaint(two, Incremental(), false).find("this log has several"), std::string::npos);
}

}  // namespace
}  // namespace cairn::landmark_map
