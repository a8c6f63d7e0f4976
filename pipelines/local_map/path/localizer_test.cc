#include "pipelines/local_map/path/localizer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/local_map/testing/corridor.h"
#include "pipelines/local_map/testing/drive.h"
#include "pipelines/local_map/traces/recorder.h"
#include "schema/allocations_testing.h"

namespace cairn::local_map {
namespace {

constexpr double kDistance_m = 9;

struct Known {
  TraceGraph graph;
  TraceFrame frame;
};

// A trace of the corridor from one end to the other.
Known RecordCorridor() {
  Drive drive(NichedCorridor(), {-4.8, 0, 0}, 1);
  for (int k = 0; k < 5; ++k) drive.Scan();
  TraceRecorder recorder(drive.grids());
  recorder.Begin(drive.grids(), drive.time_s());
  for (double gone = 0; gone < kDistance_m; gone += Drive::kSpeedMS * Drive::kScanS) {
    drive.Step();
    if (recorder.Update(drive.grids(), drive.time_s()) != TraceEnd::kNone) break;
  }
  Known known;
  known.frame = recorder.frame();
  known.graph.Add(recorder.trace(), recorder.frame().quarter);
  return known;
}

double ErrorM(const Known& known, const Position& at, const Pose& robot) {
  const Position truth = known.frame.At({robot.x_m, robot.y_m}, 0.15);
  return std::hypot(at.z_m - truth.z_m, at.u_m - truth.u_m);
}

// Drives through the corridor again, believed to be off by so much at first.
struct Again {
  Known known = RecordCorridor();
  Drive drive{NichedCorridor(), {-4.8, 0.1, 0}, 2};
  TraceLocalizer localizer;
  double last_m = 0;
  int corrected = 0;

  explicit Again(const Position& off, const SearchWindow& range, const LocalizerOptions& options = {})
      : localizer(drive.grids(), options, 8) {
    for (int k = 0; k < 5; ++k) drive.Scan();
    Position at = known.frame.At({drive.pose().x_m, drive.pose().y_m}, 0.15);
    localizer.Begin(0, Position{at.z_m + off.z_m, at.u_m + off.u_m}, range);
  }
  void Go(double distance_m) {
    for (double gone = 0; gone < distance_m; gone += Drive::kSpeedMS * Drive::kScanS) {
      drive.Step();
      localizer.Update(drive.grids(), known.graph);
      corrected += localizer.held(0)->corrected ? 1 : 0;
      last_m = ErrorM(known, localizer.held(0)->at, drive.pose());
    }
  }
};

TEST(TraceLocalizer, CorrectsAPositionThatIsOffAndNarrowsItsRange) {
  Again again({0.3, 0.2}, {0.5, 0.5});
  again.Go(7);
  EXPECT_GT(again.corrected, 20);
  EXPECT_LT(again.last_m, 0.12);
  EXPECT_LT(again.localizer.held(0)->range.u_m, 0.3);
}

TEST(TraceLocalizer, RecoversFromAJumpThatItIsToldOf) {
  Again again({1.2, -0.3}, {0.1, 0.1});
  again.localizer.Update(again.drive.grids(), again.known.graph, 0.6);
  again.Go(8);
  EXPECT_LT(again.last_m, 0.15);
}

TEST(TraceLocalizer, OpensItsRangesWhereNothingCanBeCorrectedForLong) {
  LocalizerOptions options;
  options.lost_m = 1;
  options.match.min_known = 1000;
  options.range_per_m = 0.5;
  Again again({0, 0}, {0.1, 0.1}, options);
  again.Go(0.9);
  EXPECT_LE(again.localizer.held(0)->range.z_m, options.most_m);
  again.Go(5);
  EXPECT_GT(again.localizer.held(0)->range.z_m, 2);
}

TEST(TraceLocalizer, RangesGrowWithTheWayWhereNothingCanBeChecked) {
  Again again({0, 0}, {0.1, 0.1});
  again.localizer.Begin(0, Position{500, 0}, {0.1, 0.1});  // far from what was recorded
  again.Go(3);
  EXPECT_FALSE(again.localizer.held(0)->active);
  EXPECT_NEAR(again.localizer.held(0)->range.z_m, 0.1 + 3 * 0.02, 0.01);
}

TEST(TraceLocalizer, HandsAPositionOnToAConnectedTraceThatHasNone) {
  Again again({0, 0}, {0.1, 0.1});
  // The same corridor once more, its frame a metre further back.
  const int other = again.known.graph.Add(again.known.graph.node(0).trace, again.known.frame.quarter);
  again.known.graph.Connect({0, other, 0, {0, 0}, 0.05});
  again.localizer.Begin(other, std::nullopt, {});
  again.Go(1);
  ASSERT_TRUE(again.localizer.held(other).has_value());
  EXPECT_TRUE(again.localizer.held(other)->active);
  EXPECT_LT(ErrorM(again.known, again.localizer.held(other)->at, again.drive.pose()), 0.15);
}

TEST(TraceLocalizer, TakesASurerPositionWhereMatchingSaysNothing) {
  LocalizerOptions options;
  options.match.min_known = 1000;  // nothing can be matched
  Again again({0, 0}, {0.1, 0.1}, options);
  const int other = again.known.graph.Add(again.known.graph.node(0).trace, again.known.frame.quarter);
  again.known.graph.Connect({0, other, 0, {0, 0}, 0.02});
  const Position at = again.known.frame.At({again.drive.pose().x_m, again.drive.pose().y_m}, 0.15);
  again.localizer.Begin(other, Position{at.z_m + 0.3, at.u_m - 0.2}, {0.5, 0.5});
  again.Go(0.3);
  EXPECT_EQ(again.corrected, 0);
  EXPECT_NEAR(again.localizer.held(other)->at.z_m, again.localizer.held(0)->at.z_m, 1e-9);
  EXPECT_NEAR(again.localizer.held(other)->at.u_m, again.localizer.held(0)->at.u_m, 1e-9);
}

// Two traces of a room, along either pair of its walls; the robot is believed to be off by as much in both.
TEST(TraceLocalizer, CorrectsTracesThatCrossTogether) {
  std::vector<TestWall> room = TestBox(3.4, 3.4, {0, 0, 0});
  for (const TestWall& wall : TestBox(0.8, 0.5, {0.6, -1.45, 0})) room.push_back(wall);
  const auto drive_in = [](Drive* drive) {
    drive->Ahead(0.5);
    for (int k = 0; k < 40; ++k) drive->Scan();
  };
  Drive before(room, {-0.5, 0, 0}, 3), now(room, {-0.45, 0.05, 0}, 4);
  drive_in(&before);
  drive_in(&now);
  ImmediateTrace along = ImmediateRoom(before.grids()), across = ImmediateRoom(before.grids());
  MakeImmediate(before.grids(), 0, along);
  MakeImmediate(before.grids(), 1, across);
  TraceGraph graph;
  graph.Add(along.trace, 0);
  graph.Add(across.trace, 1);
  const Connection crossing{
      0, 1, 1, {along.robot.z_m + across.robot.u_m, along.robot.u_m - across.robot.z_m}, 0.02};
  graph.Connect(crossing);
  TraceLocalizer localizer(now.grids(), {}, 2);
  const Position truth{along.robot.z_m + now.pose().x_m - before.pose().x_m,
                       along.robot.u_m + now.pose().y_m - before.pose().y_m};
  const Position off{truth.z_m + 0.2, truth.u_m - 0.15};
  localizer.Begin(0, off, {0.4, 0.4});
  localizer.Begin(1, Through(crossing, off), {0.4, 0.4});
  localizer.Update(now.grids(), graph);
  ASSERT_TRUE(localizer.held(0)->corrected);
  ASSERT_TRUE(localizer.held(1)->corrected);
  const Position one = localizer.held(0)->at, two = Back(crossing, localizer.held(1)->at);
  EXPECT_NEAR(one.z_m, two.z_m, 1e-6);
  EXPECT_NEAR(one.u_m, two.u_m, 1e-6);
  EXPECT_LT(std::hypot(one.z_m - truth.z_m, one.u_m - truth.u_m), 0.08);
}

TEST(TraceLocalizer, AllocatesNothingOnceItIsMade) {
  Again again({0.1, 0.1}, {0.3, 0.3});
  again.Go(0.5);
  long allocated = 0;
  for (int k = 0; k < 30; ++k) {
    again.drive.Step();
    const long before = Allocations();
    again.localizer.Update(again.drive.grids(), again.known.graph);
    allocated += Allocations() - before;
  }
  EXPECT_EQ(allocated, 0);
}

}  // namespace
}  // namespace cairn::local_map
