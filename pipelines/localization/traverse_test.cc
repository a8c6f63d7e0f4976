#include "pipelines/localization/traverse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "schema/error.h"

namespace cairn::localization {
namespace {

// Two runs of 100 samples, 0.2 m apart.
Source TwoRuns() {
  Source source;
  source.run_names = {"a", "b"};
  source.feature_names = {"f"};
  source.groups = {{0, 1}};
  for (const std::int32_t index : {0, 1}) {
    Run run{.index = index,
            .positions = {},
            .heading_rad = {},
            .output = std::vector<float>(100, 0.5F),
            .odometry = {}};
    for (int k = 0; k < 100; ++k) run.positions.push_back({0.2 * k, 0.0});
    source.runs.push_back(run);
  }
  return source;
}

TEST(Traverse, StopsAtTheFirstSampleAfterEachStretch) {
  const Options options{.traverses = 0, .travelled_m = 3.0, .every_m = 0.5, .odometry_ratio = 0.0};
  const Traverse traverse = MakeTraverse(options, TwoRuns(), 1, 9);
  EXPECT_EQ(traverse.run, 1U);
  EXPECT_EQ(traverse.start, 0U);
  std::vector<std::size_t> samples;
  double travelled_m = 0.0;
  for (const Stop& stop : traverse.stops) {
    samples.push_back(stop.sample);
    travelled_m += stop.displacement.x_m;
    EXPECT_NEAR(stop.travelled_m, travelled_m, 1e-12);
    EXPECT_NEAR(stop.travelled_m, 0.2 * static_cast<double>(stop.sample), 1e-12);
  }
  EXPECT_EQ(samples, (std::vector<std::size_t>{3, 5, 8, 10, 13, 15}));
}

TEST(Traverse, SetsOutFromPositionsThatLeaveTheWayAndReplaysFromItsSeed) {
  const Options options{.traverses = 40, .travelled_m = 12.0};
  const Source source = TwoRuns();
  bool differ = false;
  for (std::size_t number = 0; number < 40; ++number) {
    const Traverse traverse = MakeTraverse(options, source, number, 5);
    EXPECT_EQ(traverse.run, number % 2);
    EXPECT_LE(0.2 * static_cast<double>(traverse.start), 19.8 - 12.0 + 0.2);
    EXPECT_GE(traverse.stops.back().travelled_m, 11.4);
    EXPECT_EQ(MakeTraverse(options, source, number, 5).start, traverse.start);
    EXPECT_EQ(MakeTraverse(options, source, number, 5).stops[3].displacement, traverse.stops[3].displacement);
    differ |= MakeTraverse(options, source, number, 6).start != traverse.start;
  }
  EXPECT_TRUE(differ);
}

TEST(Traverse, PutsTheErrorThatIsAskedForOnDisplacements) {
  const Options options{.traverses = 500, .travelled_m = 10.0, .odometry_ratio = 0.1};
  const Source source = TwoRuns();
  double squares = 0.0;
  int count = 0;
  for (std::size_t number = 0; number < 500; ++number) {
    for (const Stop& stop : MakeTraverse(options, source, number, 1).stops) {
      squares += std::pow(stop.displacement.y_m / 0.5, 2);
      ++count;
    }
  }
  // Stops are 0.4 and 0.6 m apart in turn.
  EXPECT_NEAR(std::sqrt(squares / count), 0.1 * std::sqrt((0.16 + 0.36) / 2) / 0.5, 0.003);
}

// On a quarter of a circle of radius 5 m, driven anticlockwise: at each stop it got forward and to its left.
TEST(Traverse, TurnsDisplacementsIntoForwardAndLeftWhereHeadingsAreKnown) {
  Source source = TwoRuns();
  auto& run = source.runs[0];
  for (int k = 0; k < 100; ++k) {
    const double turned = 0.015 * k;
    run.positions[static_cast<std::size_t>(k)] = {5.0 * std::cos(turned), 5.0 * std::sin(turned)};
    run.heading_rad.push_back(std::remainder(turned + 0.5 * std::numbers::pi, 2 * std::numbers::pi));
  }
  const Options options{.traverses = 0, .travelled_m = 5.0, .every_m = 1.0, .odometry_ratio = 0.0};
  const Traverse traverse = MakeTraverse(options, source, 0, 9);
  ASSERT_GE(traverse.stops.size(), 4U);
  std::size_t last = 0;
  for (const Stop& stop : traverse.stops) {
    const double turned = 0.015 * static_cast<double>(stop.sample - last);
    EXPECT_NEAR(stop.own.turn_rad, turned, 1e-12);
    EXPECT_NEAR(stop.own.moved.x_m, 5.0 * std::sin(turned), 1e-12);
    EXPECT_NEAR(stop.own.moved.y_m, 5.0 * (1.0 - std::cos(turned)), 1e-12);
    last = stop.sample;
  }
}

// Odometry on the same circle that says so: 0.015 rad and 7.5 cm a sample, whatever the labels are.
TEST(Traverse, AddsUpRecordedOdometryFromTheHeadingAtTheStopBefore) {
  Source source = TwoRuns();
  auto& run = source.runs[0];
  run.heading_rad.assign(100, 1.0);
  run.odometry.assign(100, {{0.075, 0.0}, 0.015});
  run.odometry[0] = {{99.0, 99.0}, 99.0};  // of the first there is no way
  const Options options{.traverses = 0, .travelled_m = 8.0, .every_m = 2.0, .odometry_ratio = 0.5};
  const Traverse traverse = MakeTraverse(options, source, 0, 9);
  ASSERT_EQ(traverse.stops.size(), 4U);
  std::size_t last = 0;
  for (const Stop& stop : traverse.stops) {
    Position forward;
    for (std::size_t k = 1; k <= stop.sample - last; ++k) {
      forward.x_m += 0.075 * std::cos(0.015 * static_cast<double>(k));
      forward.y_m += 0.075 * std::sin(0.015 * static_cast<double>(k));
    }
    EXPECT_NEAR(stop.own.turn_rad, 0.015 * static_cast<double>(stop.sample - last), 1e-12);
    EXPECT_NEAR(stop.own.moved.x_m, forward.x_m, 1e-12);
    EXPECT_NEAR(stop.own.moved.y_m, forward.y_m, 1e-12);
    EXPECT_NEAR(stop.displacement.x_m, std::cos(1.0) * forward.x_m - std::sin(1.0) * forward.y_m, 1e-12);
    last = stop.sample;
  }
}

TEST(Traverse, NeedsAStop) {
  EXPECT_THROW(MakeTraverse({.traverses = 0, .travelled_m = 0.0, .every_m = 30.0}, TwoRuns(), 0, 1),
               InputError);
}

}  // namespace
}  // namespace cairn::localization
