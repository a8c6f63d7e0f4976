#include "pipelines/local_map/traces/recorder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/local_map/testing/drive.h"
#include "schema/allocations_testing.h"

namespace cairn::local_map {
namespace {

std::vector<TestWall> TestCorridor() {
  return {{{-9, 1}, {9, 1}},      {{-9, -1}, {0, -1}},  {{0, -1}, {0, -1.5}},
          {{0, -1.5}, {2, -1.5}}, {{2, -1.5}, {2, -1}}, {{2, -1}, {9, -1}}};
}

TEST(TraceRecorder, HoldsAWayLongerThanTheGrids) {
  Drive drive(TestCorridor(), {-4, 0, 0}, 1);
  drive.Ahead(1);
  TraceRecorder recorder(drive.grids());
  recorder.Begin(drive.grids(), drive.time_s());
  for (int k = 0; k < 75; ++k) {
    drive.Step();
    ASSERT_EQ(recorder.Update(drive.grids(), drive.time_s()), TraceEnd::kNone);
  }
  EXPECT_NEAR(recorder.RobotAt(drive.grids()).z_m, 6, 0.2);
  const double origin_x = recorder.frame().origin.i * 0.15;
  int left = 0, niche = 0;
  for (int z = 0; z <= 40; ++z) {
    const Feature& feature = *recorder.trace().Find(z);
    const double x = origin_x + z * 0.15;
    if (feature.left.known()) {
      EXPECT_NEAR(feature.left.distance_m.centre(), 1, 0.1) << x;
      ++left;
    }
    if (x < 0.4 || x > 1.6 || !feature.right.known()) continue;
    EXPECT_NEAR(feature.right.distance_m.centre(), 1.5, 0.1) << x;
    ++niche;
  }
  EXPECT_GT(left, 35);
  EXPECT_GT(niche, 3);
}

// The same way driven back is the same trace, from its other end.
TEST(TraceRecorder, FollowsARobotThatDrivesBackwards) {
  Drive drive(TestCorridor(), {4, 0, 0}, 1);
  for (int k = 0; k < 12; ++k) drive.StepBack();
  TraceRecorder recorder(drive.grids());
  recorder.Begin(drive.grids(), drive.time_s());
  EXPECT_FALSE(recorder.backwards());
  for (int k = 0; k < 75; ++k) {
    drive.StepBack();
    ASSERT_EQ(recorder.Update(drive.grids(), drive.time_s()), TraceEnd::kNone);
  }
  EXPECT_TRUE(recorder.backwards());
  EXPECT_NEAR(recorder.RobotAt(drive.grids()).z_m, -6, 0.2);
  const EdgeTrace back = Reversed(recorder.trace());
  const TraceFrame frame = recorder.frame().Back();
  EXPECT_EQ(frame.quarter, 2);
  const double origin_x = frame.origin.i * 0.15;
  int right = 0, niche = 0;
  for (int z = 0; z <= 40; ++z) {
    ASSERT_NE(back.Find(z), nullptr) << z;
    const Feature& feature = *back.Find(z);
    const double x = origin_x - z * 0.15;
    if (feature.right.known()) {
      EXPECT_NEAR(feature.right.distance_m.centre(), 1, 0.1) << x;
      ++right;
    }
    if (x < 0.4 || x > 1.6 || !feature.left.known()) continue;
    EXPECT_NEAR(feature.left.distance_m.centre(), 1.5, 0.1) << x;
    ++niche;
  }
  EXPECT_GT(right, 35);
  EXPECT_GT(niche, 3);
}

// Who goes back the way that he came begins another trace, which the first one may be found on.
TEST(TraceRecorder, EndsWhereTheRobotGoesBack) {
  Drive drive(TestCorridor(), {-4, 0, 0}, 1);
  drive.Ahead(1);
  TraceRecorder recorder(drive.grids());
  for (const bool first_ahead : {true, false}) {
    recorder.Begin(drive.grids(), drive.time_s());
    const auto step = [&](bool ahead) {
      if (ahead)
        drive.Step();
      else
        drive.StepBack();
      return recorder.Update(drive.grids(), drive.time_s());
    };
    for (int k = 0; k < 25; ++k) ASSERT_EQ(step(first_ahead), TraceEnd::kNone);
    int back = 1;
    while (back < 25 && step(!first_ahead) == TraceEnd::kNone) ++back;
    EXPECT_NEAR(back * Drive::kSpeedMS * Drive::kScanS, 0.64, 0.09);
  }
}

TEST(TraceRecorder, AllocatesNothingOnceItIsMade) {
  Drive drive(TestCorridor(), {-4, 0, 0}, 1);
  drive.Ahead(1);
  TraceRecorder recorder(drive.grids());
  ImmediateTrace now = ImmediateRoom(drive.grids());
  long allocated = 0;
  const auto watch = [&](const auto& work) {
    const long before = Allocations();
    work();
    allocated += Allocations() - before;
  };
  for (int k = 0; k < 2; ++k) {
    watch([&] { recorder.Begin(drive.grids(), drive.time_s()); });
    for (int step = 0; step < 20; ++step) {
      drive.Step();
      watch([&] { recorder.Update(drive.grids(), drive.time_s()); });
      watch([&] { MakeImmediate(drive.grids(), 0, now); });
    }
    EXPECT_GT(recorder.trace().features().size(), 31U);
  }
  watch([&] { recorder.Begin(drive.grids(), drive.time_s()); });
  for (int step = 0; step < 20; ++step) {
    drive.StepBack();
    watch([&] { recorder.Update(drive.grids(), drive.time_s()); });
  }
  EXPECT_GT(recorder.trace().features().size(), 31U);
  EXPECT_EQ(allocated, 0);
}

TEST(TraceRecorder, EndsAtATurn) {
  Drive drive(TestBox(8, 8, {}), {-2, 0, 0}, 1);
  drive.Ahead(1);
  TraceRecorder recorder(drive.grids());
  recorder.Begin(drive.grids(), drive.time_s());
  TraceEnd end = TraceEnd::kNone;
  double turned = 0;
  while (end == TraceEnd::kNone && turned < 1.5) {
    turned += 0.1;
    drive.Step(0.1);
    end = recorder.Update(drive.grids(), drive.time_s());
  }
  EXPECT_EQ(end, TraceEnd::kTurn);
  EXPECT_NEAR(turned, 0.4, 0.11);
}

TEST(TraceRecorder, EndsAtAHint) {
  Drive drive(TestCorridor(), {-4, 0, 0}, 1);
  drive.Ahead(1);
  TraceRecorder recorder(drive.grids());
  recorder.Begin(drive.grids(), drive.time_s());
  EXPECT_EQ(recorder.Update(drive.grids(), drive.time_s(), true), TraceEnd::kHint);
  EXPECT_GT(recorder.trace().features().size(), 0U);
}

TEST(TraceRecorder, IsFullAtItsCapacity) {
  Drive drive(TestCorridor(), {-4, 0, 0}, 1);
  drive.Ahead(1);
  RecorderOptions options;
  options.capacity = 40;
  TraceRecorder recorder(drive.grids(), options);
  recorder.Begin(drive.grids(), drive.time_s());
  int scans = 0;
  for (; scans < 50; ++scans) {
    drive.Step();
    if (recorder.Update(drive.grids(), drive.time_s()) != TraceEnd::kNone) break;
  }
  EXPECT_LT(scans, 50);
  EXPECT_LE(recorder.trace().features().size(), 40U);
}

// A box stands in the way; the robot waits before it.
double BlockedForS(bool leaves) {
  Drive drive(TestCorridor(), {-4, 0, 0}, 1);
  drive.Ahead(1);
  TraceRecorder recorder(drive.grids());
  recorder.Begin(drive.grids(), drive.time_s());
  drive.walls().push_back({{drive.pose().x_m + 0.7, -0.4}, {drive.pose().x_m + 0.7, 0.4}});
  const double begin_s = drive.time_s();
  while (drive.time_s() < begin_s + 60) {
    drive.Scan();
    if (leaves && drive.time_s() > begin_s + 20) drive.walls().resize(TestCorridor().size());
    if (recorder.Update(drive.grids(), drive.time_s()) == TraceEnd::kBlocked) return drive.time_s() - begin_s;
  }
  return INFINITY;
}

TEST(TraceRecorder, EndsAtAnObstacleThatStaysThirtySeconds) { EXPECT_NEAR(BlockedForS(false), 30, 3); }

TEST(TraceRecorder, GoesOnWhenTheObstacleLeaves) { EXPECT_TRUE(std::isinf(BlockedForS(true))); }

}  // namespace
}  // namespace cairn::local_map
