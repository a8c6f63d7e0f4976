#include "pipelines/local_map/traces/graph.h"

#include <gtest/gtest.h>

namespace cairn::local_map {
namespace {

TEST(TraceGraph, AConnectionLeadsThereAndBack) {
  // `to` begins 3 m ahead and 1 m left of `from`, and runs to the left.
  const Connection connection{0, 1, 1, {3, 1}, 0.1};
  const Position there = Through(connection, {3, 2.5});
  EXPECT_NEAR(there.z_m, 1.5, 1e-12);
  EXPECT_NEAR(there.u_m, 0, 1e-12);
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Connection any{0, 1, quarter, {-2, 0.7}, 0.1};
    const Position back = Back(any, Through(any, {1.3, -0.4}));
    EXPECT_NEAR(back.z_m, 1.3, 1e-12);
    EXPECT_NEAR(back.u_m, -0.4, 1e-12);
  }
}

TEST(TraceGraph, KeepsTheStrongerOfTwoConnections) {
  TraceGraph graph;
  graph.Add({}, 0);
  graph.Add({}, 1);
  graph.Connect({0, 1, 1, {1, 0}, 0.3});
  graph.Connect({0, 1, 1, {2, 0}, 0.1});
  graph.Connect({0, 1, 1, {3, 0}, 0.2});
  ASSERT_EQ(graph.connections().size(), 1U);
  EXPECT_EQ(graph.connection(0).origin.z_m, 2);
  EXPECT_EQ(graph.node(0).connections.size(), 1U);
  EXPECT_EQ(graph.node(1).connections.size(), 1U);
}

}  // namespace
}  // namespace cairn::local_map
