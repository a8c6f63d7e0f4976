#include "pipelines/local_map/traces/edge_trace.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/local_map/testing/trace.h"

namespace cairn::local_map {
namespace {

TEST(EdgeTrace, GrowsToItsCapacityAndNoFurther) {
  EdgeTrace trace(0.15, -3, 5);
  EXPECT_EQ(trace.Touch(2), nullptr);
  EXPECT_EQ(trace.Find(0), nullptr);
  ASSERT_NE(trace.Touch(1), nullptr);
  EXPECT_EQ(trace.end_z(), 2);
  ASSERT_NE(trace.Find(-3), nullptr);
  EXPECT_FALSE(trace.Find(-3)->left.known());
  trace.Restart(0.3, 7);
  EXPECT_EQ(trace.features().size(), 0U);
  EXPECT_EQ(trace.first_z(), 7);
}

TEST(EdgeTrace, GrowsAtBothEnds) {
  EdgeTrace trace(0.15, -1, 6);
  trace.Touch(1)->left.cross_m = 0.1F;
  trace.Touch(-3)->left.cross_m = 0.3F;
  EXPECT_EQ(trace.first_z(), -3);
  EXPECT_EQ(trace.end_z(), 2);
  EXPECT_EQ(trace.Find(1)->left.cross_m, 0.1F);
  EXPECT_EQ(trace.Find(-3)->left.cross_m, 0.3F);
  EXPECT_TRUE(std::isnan(trace.Find(-2)->left.cross_m));
  EXPECT_EQ(trace.Touch(-5), nullptr);
  EXPECT_NE(trace.Touch(-4), nullptr);
  EXPECT_EQ(trace.features().size(), 6U);
}

TEST(EdgeTrace, DrivenBackHasItsSidesAndItsWayTurned) {
  const EdgeTrace there = HandTrace(Corridor(), {}, -4, 31), back = Reversed(there);
  EXPECT_EQ(back.first_z(), -30);
  EXPECT_EQ(back.end_z(), 5);
  int seen = 0;
  for (int z = -4; z < 31; ++z) {
    EXPECT_EQ(back.Find(-z)->left.distance_m.low, there.Find(z)->right.distance_m.low) << z;
    EXPECT_EQ(back.Find(-z)->right.distance_m.low, there.Find(z)->left.distance_m.low) << z;
    if (std::isnan(there.Find(z)->left.cross_m)) continue;
    EXPECT_EQ(back.Find(-z)->right.cross_m, -there.Find(z)->left.cross_m) << z;
    ++seen;
  }
  EXPECT_EQ(seen, 2);
  const EdgeTrace again = Reversed(back);
  EXPECT_EQ(again.first_z(), there.first_z());
  EXPECT_EQ(again.Find(12)->right.distance_m.low, there.Find(12)->right.distance_m.low);
}

TEST(EdgeTrace, PartKeepsItsPlace) {
  const EdgeTrace whole = HandTrace(Corridor(), {}, -4, 31), part = Part(whole, 2, 99);
  EXPECT_EQ(part.first_z(), 2);
  EXPECT_EQ(part.end_z(), 31);
  EXPECT_EQ(part.Find(14)->left.distance_m.low, whole.Find(14)->left.distance_m.low);
  EXPECT_TRUE(Part(whole, 50, 60).features().empty());
}

TEST(Interval, HoldsWhatItIncludes) {
  Interval interval;
  EXPECT_FALSE(interval.known());
  for (const float value : {2.0F, 3.0F, 1.0F}) interval.Include(value);
  EXPECT_EQ(interval.low, 1);
  EXPECT_EQ(interval.high, 3);
  EXPECT_EQ(interval.centre(), 2);
}

}  // namespace
}  // namespace cairn::local_map
