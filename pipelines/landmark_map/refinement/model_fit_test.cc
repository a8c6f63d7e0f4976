#include "pipelines/landmark_map/refinement/model_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {
namespace {

// A robot drives 20 m straight on, a metre at a time, and sees a landmark from each metre, exactly where it
// is.
struct Straight {
  LeastSquaresProblem problem;
  LeastSquaresPoint point;
};

Straight Drive() {
  Straight drive;
  NodeTrack track;
  drive.point.nodes.resize(1);
  drive.point.landmarks = {{10.0, 5.0}};
  drive.point.errors.resize(1);
  for (int k = 0; k <= 20; ++k) {
    track.time_s.push_back(k);
    if (k > 0) track.controls.push_back({{0.0, 1.0}});
    drive.point.nodes[0].emplace_back(k, 0.0, 0.0);
    drive.problem.sightings.push_back({0, k, 0, 10.0 - k, 5.0});
  }
  drive.problem.robots = {track};
  drive.problem.landmarks = 1;
  drive.problem.widths = {{0.01, 0.01, 0.02}};
  drive.problem.noise.range_m = 0.1;
  drive.problem.noise.bearing_rad = 0.02;
  return drive;
}

TEST(FitOf, WhatIsExactFits) {
  const Straight drive = Drive();
  const ModelFit fit = FitOf(drive.problem, drive.problem, drive.point);
  EXPECT_EQ(fit.observations, 21);
  EXPECT_EQ(fit.misfits, 0);
  EXPECT_EQ(fit.longest_run, 0);
  EXPECT_EQ(fit.odometry_misfits, 0);
  EXPECT_TRUE(fit.worst.empty());
}

TEST(FitOf, NamesTheLongestRunAndTheWorst) {
  Straight drive = Drive();
  for (const int k : {2, 3, 9, 10, 11, 12, 15})
    drive.problem.sightings[static_cast<std::size_t>(k)].y_m -= 2.0;
  drive.problem.sightings[11].y_m -= 2.0;
  const ModelFit fit = FitOf(drive.problem, drive.problem, drive.point);
  EXPECT_EQ(fit.misfits, 7);
  EXPECT_EQ(fit.longest_run, 4);
  EXPECT_EQ(fit.longest_run_from_s, 9.0);
  ASSERT_EQ(fit.worst.size(), 7U);
  EXPECT_EQ(fit.worst.front().time_s, 11.0);
  EXPECT_GT(fit.worst.front().sigmas, fit.worst.back().sigmas);
}

TEST(FitOf, NamesTheLandmarkThatMostMisfitsAreOf) {
  Straight drive = Drive();
  drive.problem.landmarks = 3;
  drive.point.landmarks = {{10.0, 5.0}, {10.0, 5.0}, {10.0, 5.0}};
  for (const int k : {0, 1, 2, 3, 4, 5}) drive.problem.sightings[static_cast<std::size_t>(k)].landmark = 2;
  for (const int k : {2, 3, 5, 11, 12}) drive.problem.sightings[static_cast<std::size_t>(k)].y_m -= 2.0;
  const ModelFit fit = FitOf(drive.problem, drive.problem, drive.point);
  EXPECT_EQ(fit.misfits, 5);
  EXPECT_EQ(fit.misfit_landmark, 2);
  EXPECT_EQ(fit.landmark_misfits, 3);
  EXPECT_EQ(fit.landmark_observations, 6);
  std::vector<Landmark> landmarks(3);
  landmarks[2].type = 7;
  const auto stored = [&](const ModelFit& of, int types) {
    return FieldsIn<kinds::LandmarkMap::Fit>("", of.ToBlob(landmarks, types));
  };
  EXPECT_EQ(stored(fit, 8).misfit_landmark.Scalar(), 7) << "by its name, whatever others are left out";
  EXPECT_EQ(stored(fit, 8).landmark_misfits.Scalar(), 3);
  EXPECT_EQ(stored(fit, 8).landmark_observations.Scalar(), 6);
  EXPECT_EQ(stored(fit, 7).misfit_landmark.Scalar(), -1) << "it has none";
  const Straight exact = Drive();
  EXPECT_FALSE(stored(FitOf(exact.problem, exact.problem, exact.point), 8).misfit_landmark);
}

TEST(FitOf, ASlipIsAMisfitOfOdometry) {
  Straight drive = Drive();
  drive.problem.robots[0].controls[6] = {{0.5, 1.0}};
  const ModelFit fit = FitOf(drive.problem, drive.problem, drive.point);
  EXPECT_EQ(fit.odometry_misfits, 1);
  EXPECT_EQ(fit.worst_odometry_s, 7.0);
}

// From node k it sees the landmark 0 up to node 10, and from there on the landmark 1; the others as told.
ModelFit FitOfSeen(const std::vector<Sighting>& more) {
  Straight drive = Drive();
  for (Sighting& seen : drive.problem.sightings) seen.landmark = seen.node > 10;
  std::vector<Sighting>& all = drive.problem.sightings;
  for (const Sighting& seen : more) {
    if (seen.robot > 0 && drive.problem.robots.size() < 2) {
      drive.problem.robots.push_back(drive.problem.robots[0]);
      drive.problem.widths.push_back(drive.problem.widths[0]);
      drive.point.nodes.push_back(drive.point.nodes[0]);
      drive.point.errors.emplace_back();
    }
    all.push_back(seen);
  }
  std::ranges::stable_sort(all, {}, [](const Sighting& seen) { return std::pair(seen.robot, seen.node); });
  drive.problem.landmarks = 3;
  drive.point.landmarks = {{10.0, 5.0}, {10.0, 5.0}, {10.0, 5.0}};
  return FitOf(drive.problem, drive.problem, drive.point);
}

TEST(FitOf, NamesTheTimeThatFewestLandmarksHoldTogether) {
  EXPECT_EQ(FitOf(Drive().problem, Drive().problem, Drive().point).fewest_common, 1);
  const ModelFit halves = FitOfSeen({});
  EXPECT_EQ(halves.fewest_common, 0);
  EXPECT_EQ(halves.fewest_common_s, 10.0);
  EXPECT_EQ(FitOfSeen({{0, 4, 2, 6.0, 5.0}, {0, 14, 2, -4.0, 5.0}}).fewest_common, 1)
      << "the landmark 2 is seen from both halves";
  EXPECT_EQ(FitOfSeen({{0, 20, 0, -10.0, 5.0}}).fewest_common, 1)
      << "at its end it is back at the landmark 0";
}

TEST(FitOf, WhatAnotherRobotSeesOfBothHalvesHoldsThemTogether) {
  const auto other = [](int landmark) { return Sighting{1, 5, landmark, 5.0, 5.0}; };
  EXPECT_EQ(FitOfSeen({other(0), other(1)}).fewest_common, 1);
  EXPECT_EQ(FitOfSeen({other(0), other(0)}).fewest_common, 0);
}

TEST(FitOf, TellsStatedWidthsFromFoundOnes) {
  const Straight drive = Drive();
  LeastSquaresProblem found = drive.problem;
  found.noise.range_m = 0.3;
  const ModelFit fit = FitOf(drive.problem, found, drive.point);
  ASSERT_EQ(fit.widths.size(), 2U) << "range and bearing: there is no contact";
  EXPECT_EQ(fit.widths[0].kind, "range");
  EXPECT_EQ(fit.widths[0].stated, 0.1);
  EXPECT_EQ(fit.widths[0].found, 0.3);
  EXPECT_EQ(fit.widths[1].kind, "bearing");
}

}  // namespace
}  // namespace cairn::landmark_map
