#include "pipelines/local_map/traces/match.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/local_map/testing/trace.h"
#include "schema/allocations_testing.h"

namespace cairn::local_map {
namespace {

const MatchOptions kMatchOptions;

// What a robot at `at` of the world sees, in a trace whose origin is at the centre of its cell.
ImmediateTrace SeenFrom(const HandWorld& world, const Position& at, const Position& in_cell = {}) {
  return {HandTrace(world, {at.z_m - in_cell.z_m, at.u_m - in_cell.u_m}, -15, 16), in_cell};
}

TEST(Correct, FindsWhereTheRobotIsToAFractionOfACell) {
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -15, 45);
  int tried = 0;
  for (const double z : {0.9, 1.03, 1.61})
    for (const double u : {-0.17, 0.0, 0.11})
      for (const double off : {-0.3, 0.2}) {
        const ImmediateTrace now = SeenFrom(Corridor(), {z, u}, {0.04, -0.05});
        const Match match = Correct(recorded, now, {z + off, u - off}, {0.6, 0.6}, kMatchOptions);
        EXPECT_EQ(match.verdict, Verdict::kCorrected);
        EXPECT_NEAR(match.z_m, z, 0.03);
        EXPECT_NEAR(match.u_m, u, 0.02);
        EXPECT_LT(match.sd_z_m, 0.15);
        EXPECT_LT(match.sd_u_m, 0.1);
        EXPECT_GT(match.sides_after, match.sides_before);
        ++tried;
      }
  EXPECT_EQ(tried, 18);
}

TEST(Correct, ConfirmsAPositionThatIsRight) {
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -15, 45);
  const Match match = Correct(recorded, SeenFrom(Corridor(), {1, 0.1}), {1, 0.1}, {0.5, 0.5}, kMatchOptions);
  EXPECT_EQ(match.verdict, Verdict::kConfirmed);
}

TEST(Correct, InABlankCorridorDeterminesUAndNotZ) {
  const HandWorld blank{{{-99, 1}}, {{-99, 1}}, {}, {}};
  const EdgeTrace recorded = HandTrace(blank, {}, -50, 90);
  const Match match = Correct(recorded, SeenFrom(blank, {1, 0.2}), {1.3, 0}, {0.5, 0.5}, kMatchOptions);
  EXPECT_EQ(match.verdict, Verdict::kCorrected);
  EXPECT_TRUE(std::isinf(match.sd_z_m));
  EXPECT_EQ(match.z_m, 1.3);
  EXPECT_NEAR(match.u_m, 0.2, 0.01);
}

TEST(Correct, SaysThatNothingIsKnown) {
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -15, 45), empty = HandTrace({}, {}, -15, 16);
  EXPECT_EQ(Correct(recorded, {empty, {}}, {1, 0}, {0.5, 0.5}, kMatchOptions).verdict, Verdict::kUnknown);
  EXPECT_EQ(Correct(empty, SeenFrom(Corridor(), {1, 0}), {1, 0}, {0.5, 0.5}, kMatchOptions).verdict,
            Verdict::kUnknown);
}

TEST(Correct, RefusesWhatLiesBeyondTheRange) {
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -15, 45);
  const Match match = Correct(recorded, SeenFrom(Corridor(), {1, 0.4}), {1, 0}, {0.3, 0.2}, kMatchOptions);
  EXPECT_FALSE(match.usable());
}

// Of the left wall eight features lie where they were recorded, a similarity of 1, and eight lie 2 m off, 33
// standard deviations, one of -1: as much speaks against the place as for it.
TEST(Correct, RefusesWhatIsAsUnlikeAsItIsAlike) {
  const HandWorld before{{{-99, 1}}, {}, {}, {}}, half_gone{{{-99, 1}, {0, 3}}, {}, {}, {}};
  const EdgeTrace recorded = HandTrace(before, {}, -50, 90);
  const ImmediateTrace now{HandTrace(half_gone, {}, -8, 8), {}};
  const Match match = Correct(recorded, now, {}, {0.5, 0.5}, kMatchOptions);
  EXPECT_EQ(match.known, 16);
  EXPECT_EQ(match.sides_after, 0);
  EXPECT_EQ(match.verdict, Verdict::kRefused);
}

TEST(Correct, AllocatesNothing) {
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -15, 45);
  const ImmediateTrace now = SeenFrom(Corridor(), {1, 0.1});
  const long before = Allocations();
  const Match match = Correct(recorded, now, {1.2, 0}, {0.6, 0.6}, kMatchOptions);
  const PairMatch pair =
      CorrectPair({recorded, now, {1, 0}}, {recorded, now, {1, 0}}, 1, {0.5, 0.5}, kMatchOptions);
  EXPECT_EQ(Allocations(), before);
  EXPECT_TRUE(match.usable());
  EXPECT_GT(pair.first.known, 0);
}

// The cupboard is taken away and another one put elsewhere: the trimmed mean still finds the place by what
// did not move.
TEST(Correct, ResistsFurnitureThatWasMoved) {
  HandWorld moved = Corridor();
  moved.right = {{-9, 1.0}, {2.0, 0.6}, {2.6, 1.0}};
  moved.cross_right = {2.0, 2.6};
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -15, 45);
  const Match match = Correct(recorded, SeenFrom(moved, {1.3, 0.1}), {1.1, 0}, {0.5, 0.5}, kMatchOptions);
  EXPECT_TRUE(match.usable());
  EXPECT_NEAR(match.z_m, 1.3, 0.06);
  EXPECT_NEAR(match.u_m, 0.1, 0.03);
}

// The first way is a blank corridor along +z; the second, which turns left from it, passes steps in its
// walls.
TEST(CorrectPair, DeterminesTogetherWhatNoneDoesAlone) {
  const HandWorld blank{{{-99, 1}}, {{-99, 1.2}}, {}, {}};
  const EdgeTrace first = HandTrace(blank, {}, -50, 90);
  const ImmediateTrace first_now = SeenFrom(blank, {1.0, 0.2});
  ASSERT_TRUE(std::isinf(Correct(first, first_now, {1.2, 0}, {0.5, 0.5}, kMatchOptions).sd_z_m));
  // The robot at (1.0, 0.2) of the first stands at (0.2, -1.0) of the second where both origins agree.
  const HandWorld across{{{-99, 2.0}}, {{-99, 0.8}}, {}, {}};
  const EdgeTrace second = HandTrace(across, {}, -50, 90);
  const ImmediateTrace second_now = SeenFrom(across, {0.2, -1.0});
  const PairMatch pair = CorrectPair({first, first_now, {1.2, 0}}, {second, second_now, {0, -1.2}}, 1,
                                     {0.5, 0.5}, kMatchOptions);
  EXPECT_EQ(pair.first.verdict, Verdict::kCorrected);
  EXPECT_NEAR(pair.first.z_m, 1.0, 0.02);
  EXPECT_NEAR(pair.first.u_m, 0.2, 0.02);
  EXPECT_NEAR(pair.second.z_m, 0.2, 0.02);
  EXPECT_NEAR(pair.second.u_m, -1.0, 0.02);
}

}  // namespace
}  // namespace cairn::local_map
