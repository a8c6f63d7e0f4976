#include "pipelines/landmark_map/refinement/row_associations.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "pipelines/landmark_map/testing.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Landmark LandmarkAt(double x_m, double y_m) { return {x_m, y_m, {1, 0, 0, 1}, 0, 1, 0}; }

// A robot that goes 10 m ahead, 1 m/s.
RefinedPath Straight() {
  kinds::Log::Odometry controls{{}, std::vector<double>(10, 0.0), std::vector<double>(10, 1.0)};
  std::vector<double> time_s;
  for (int k = 1; k <= 10; ++k) time_s.push_back(k);
  controls.time_s = time_s;
  const Odometry odometry = Integrate(controls, "rover");
  std::vector<int> node_of;
  const NodeTrack track = TrackThrough(odometry, std::vector<double>{5.0}, &node_of);
  const auto nodes = DeadReckoned(track, Eigen::Vector3d::Zero(), {});
  return {odometry, track, nodes, std::vector<Eigen::Matrix3d>(nodes.size(), Eigen::Matrix3d::Identity()),
          {},       {}};
}

kinds::Log::Observations Rows(const std::vector<double>& time_s, const std::vector<double>& range_m,
                              const std::vector<double>& bearing_rad, const std::vector<std::int32_t>& name) {
  kinds::Log::Observations seen;
  seen.time_s = time_s;
  seen.range_m = range_m;
  seen.bearing_rad = bearing_rad;
  seen.landmark = name;
  return seen;
}

// EM has used the first two: the first for the wrong one. At 4 s the robot is at (4, 0) and sees two in one
// image, where both rows lie nearest to the first landmark; a third row is of neither, a fourth is named, a
// fifth is a contact, which stay as they were.
TEST(RowsSeenFrom, GivesEveryImageItsLandmarksOnce) {
  const std::vector<Landmark> landmarks{LandmarkAt(9, 0), LandmarkAt(9.4, 0.3)};
  const auto seen = Rows({2, 4, 4, 4, 6, 7}, {7.0, 5.02, 5.25, 3.0, 3.0, kNan},
                         {0.0, 0.0, 0.03, -1.0, 0.0, kNan}, {-1, -1, -1, -1, 0, -1});
  AssociatedPath path;
  path.steps.row_observation = {0, -1, -1, -1, 1, 2};
  path.associated = {{1, 1, -1}, {0.9, 0.8, 0.7}};
  const RowAssociations em = RowsOfEm(path, seen, landmarks);
  EXPECT_EQ(em.landmark, (std::vector<std::int32_t>{1, -1, -1, -1, 1, -1}));
  EXPECT_EQ(em.probability, (std::vector<double>{0.9, 0, 0, 0, 0.8, 0.7}));
  const RowAssociations rows = RowsSeenFrom(Straight(), em, seen, landmarks, {0.3, 0.2, 0.05}, 100.0);
  EXPECT_EQ(rows.landmark, (std::vector<std::int32_t>{0, 0, 1, -1, 1, -1}));
  EXPECT_GT(rows.probability[0], 0.5);
  EXPECT_EQ(rows.probability[3], 0.0);
  EXPECT_EQ(RowsSeenFrom(Straight(), em, seen, landmarks, {0.3, 0.2, 0.05}, 3.0).landmark[1], -1)
      << "the data end before";
}

// The second and the third stand close together and no image shows both; the first and the fourth do, and an
// image shows both; the fifth has one row; the sixth is named.
TEST(WithoutDoubles, JoinsWhatNoImageShowsTwice) {
  std::vector<Landmark> landmarks{LandmarkAt(6.1, 0), LandmarkAt(5, 0), LandmarkAt(5.2, 0),
                                  LandmarkAt(5.7, 0), LandmarkAt(9, 9), LandmarkAt(20, 0)};
  for (std::size_t l = 0; l + 1 < landmarks.size(); ++l) landmarks[l].type = 1;
  const kinds::Log::Observations seen = Rows({1, 1, 2, 2, 3, 3, 4, 5}, std::vector<double>(8, 1.0),
                                             std::vector<double>(8, 0.0), std::vector<std::int32_t>(8, -1));
  const RowAssociations rows{{0, 1, 0, 1, 2, 3, 1, 4}, std::vector<double>(8, 1.0)};
  RowAssociations more = rows;
  more.landmark = {3, 2, 3, 0, 5, -1, 1, -1};
  EXPECT_EQ(WithoutDoubles(landmarks, 1, {&seen, &seen}, {rows, more}, 0.6),
            (std::vector<bool>{true, true, false, true, false, true}));
}

// The first two have names and stay, as near as they are; the third goes, for no image shows it with them;
// the fourth stays, for images show it beside the first.
TEST(WithoutDoubles, WhatHasNoNameGoesWhereItMayBeWhatHasOne) {
  std::vector<Landmark> landmarks{LandmarkAt(5, 0), LandmarkAt(4.5, 0), LandmarkAt(5.2, 0),
                                  LandmarkAt(5.4, 0)};
  landmarks[1].type = 1;
  landmarks[2].type = landmarks[3].type = 2;
  const kinds::Log::Observations seen = Rows({1, 2, 3, 3, 4, 4, 5}, std::vector<double>(7, 1.0),
                                             std::vector<double>(7, 0.0), std::vector<std::int32_t>(7, -1));
  const RowAssociations rows{{2, 2, 0, 3, 0, 3, 1}, std::vector<double>(7, 1.0)};
  EXPECT_EQ(WithoutDoubles(landmarks, 2, {&seen}, {rows}, 0.6), (std::vector<bool>{true, true, false, true}));
}

}  // namespace
}  // namespace cairn::landmark_map
