#include "datasets/evaluate/clock.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

// A robot on its way of so many seconds, a pose each `step_s`, by a clock that says `clock_s` more; each
// position `off_m` wrong.
Track WayBy(double clock_s, double step_s, double off_m = 0) {
  Track track;
  for (int i = 0; i * step_s <= 400; ++i) {
    const double t = i * step_s;
    track.time_s.push_back(t + clock_s);
    track.poses.push_back(
        {10 * std::sin(t / 37) + t / 20 + off_m * std::sin(50 * t), 7 * std::sin(t / 23), 0});
  }
  return track;
}

TEST(OtherClock, IsFoundWithItsShift) {
  for (const double clock_s : {12.0, -40.25, 0.75, 250.0}) {
    const auto clock = FindOtherClock({{WayBy(0, 1.7, 0.02), WayBy(clock_s, 0.5)}});
    ASSERT_TRUE(clock) << clock_s;
    EXPECT_NEAR(clock->shift_s, -clock_s, 0.05);
    EXPECT_LT(clock->rmse_m, 0.03);
  }
  const auto clock = FindOtherClock({{WayBy(0, 1.7), WayBy(12, 0.5)}, {WayBy(0, 2), WayBy(12, 0.5)}});
  ExpectContains(clock->Text(), "with the truth's times moved by -12.00 s");
}

TEST(OtherClock, IsFoundWhereNoTimeIsShared) {
  const auto clock = FindOtherClock({{WayBy(0, 1.7), WayBy(1.7e9, 0.5)}});
  ASSERT_TRUE(clock);
  EXPECT_NEAR(clock->shift_s, -1.7e9, 0.05);
}

// Times in nanoseconds: half a second more is the same number.
TEST(OtherClock, TimesToWhichHalfASecondAddsNothingEndTheSearch) {
  const auto clock = FindOtherClock({{WayBy(0, 1.7), WayBy(1.7e18, 0.5)}});
  EXPECT_NEAR(clock.value_or(OtherClock{-1.7e18, 0}).shift_s, -1.7e18, 1e4);
}

TEST(OtherClock, IsNoneWhereThePathsAreWrongOtherwise) {
  EXPECT_FALSE(FindOtherClock({}));
  EXPECT_FALSE(FindOtherClock({{WayBy(0, 1.7), Track()}}));
  EXPECT_FALSE(FindOtherClock({{WayBy(0, 1.7), WayBy(0, 0.5)}}));
  EXPECT_FALSE(FindOtherClock({{WayBy(0, 1.7, 3), WayBy(0, 0.5)}}));
  EXPECT_FALSE(FindOtherClock({{WayBy(0, 1.7, 3), WayBy(12, 0.5)}}));
}

}  // namespace
}  // namespace cairn::datasets
