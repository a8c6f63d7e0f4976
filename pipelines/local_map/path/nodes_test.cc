#include "pipelines/local_map/path/nodes.h"

#include <gtest/gtest.h>

namespace cairn::local_map {
namespace {

std::vector<Scan> Straight(int scans, int cut) {
  std::vector<Scan> all;
  for (int s = 0; s < scans; ++s)
    all.push_back({0.2 * s, {0.1 * s, 0, 0}, 0.1 * s, s < cut ? 0 : 1, s == cut});
  return all;
}

TEST(Nodes, BeginEachRunAndFollowTheWay) {
  const std::vector<std::size_t> nodes = ChooseNodes(Straight(31, 13), {.apart_m = 0.51});
  EXPECT_EQ(nodes, (std::vector<std::size_t>{0, 6, 12, 13, 19, 25, 30}));
}

TEST(Nodes, AnOdometryEdgeAcrossAJumpIsOfLittleWorth) {
  const std::vector<Scan> scans = Straight(31, 13);
  const std::vector<OdometryEdge> odometry_edges = MakeOdometryEdges(scans, ChooseNodes(scans, {}), 7, {});
  ASSERT_GT(odometry_edges.size(), 4U);
  EXPECT_EQ(odometry_edges[0].from, 7);
  EXPECT_LT(odometry_edges[0].along_m, 0.1);
  int wide = 0;
  for (const OdometryEdge& odometry_edge : odometry_edges) wide += odometry_edge.along_m > 1;
  EXPECT_EQ(wide, 1);
}

TEST(Nodes, WhatMovesThemIsSharedOutOverTheWay) {
  std::vector<Scan> scans = Straight(21, 100);
  const std::vector<std::size_t> nodes{0, 10, 20};
  const std::vector<Point> placed{{0, 0}, {1, 0.5}, {2, 0.7}};
  MoveTo(nodes, placed.data(), &scans);
  EXPECT_NEAR(scans[0].pose.y_m, 0, 1e-12);
  EXPECT_NEAR(scans[5].pose.y_m, 0.25, 1e-12);
  EXPECT_NEAR(scans[10].pose.y_m, 0.5, 1e-12);
  EXPECT_NEAR(scans[15].pose.y_m, 0.6, 1e-12);
  EXPECT_NEAR(scans[20].pose.y_m, 0.7, 1e-12);
}

}  // namespace
}  // namespace cairn::local_map
