#include "datasets/common/stuck_beams.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/inspect/inspect.h"
#include "datasets/testing.h"
#include "schema/rng.h"
#include "schema/store/blob_file.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kBeamsOfStuck = 8, kScansOfStuck = 300;
constexpr double kReachOfStuck_m = 5;

// Of a robot that drives to and fro in a room; beam 3 says what `of_third` says.
template <class Of>
std::vector<double> StuckReadings(const Of& of_third, bool drives = true) {
  Rng rng(5);
  std::vector<double> range_m;
  for (std::size_t s = 0; s < kScansOfStuck; ++s) {
    const double gone_m = drives ? std::sin(0.05 * static_cast<double>(s)) : 0;
    for (std::size_t b = 0; b < kBeamsOfStuck; ++b) {
      const double range =
          2 + gone_m * std::cos(static_cast<double>(b) * M_PI / 4 + 0.3) + 0.002 * rng.Normal();
      range_m.push_back(b == 3 ? of_third(range, rng) : range);
    }
  }
  return range_m;
}

TEST(StuckBeams, ABeamThatSaysTheSameWhileTheOthersChangeIsFound) {
  for (const double jitter_m : {0.0, 0.003}) {
    const auto found =
        FindStuckBeams(StuckReadings([&](double, Rng& rng) { return 1.234 + jitter_m * rng.Normal(); }),
                       kBeamsOfStuck, kReachOfStuck_m);
    ASSERT_EQ(found.size(), 1U) << jitter_m;
    EXPECT_EQ(found[0].beam, 3U);
    EXPECT_NEAR(found[0].range_m, 1.234, 0.002);
  }
}

TEST(StuckBeams, WhatChangesOrSaysNothingOrStandsStillIsNotStuck) {
  EXPECT_TRUE(
      FindStuckBeams(StuckReadings([](double range, Rng&) { return range; }), kBeamsOfStuck, kReachOfStuck_m)
          .empty());
  EXPECT_TRUE(
      FindStuckBeams(StuckReadings([](double, Rng&) { return std::nan(""); }), kBeamsOfStuck, kReachOfStuck_m)
          .empty());
  EXPECT_TRUE(
      FindStuckBeams(StuckReadings([](double, Rng&) { return 1.2; }, false), kBeamsOfStuck, kReachOfStuck_m)
          .empty());
  EXPECT_TRUE(FindStuckBeams({}, kBeamsOfStuck, kReachOfStuck_m).empty());
}

// In a hall that is wider than a sensor sees.
TEST(StuckBeams, ASensorThatGivesItsReachWhereNothingIsIsNotStuck) {
  EXPECT_TRUE(FindStuckBeams(StuckReadings([](double, Rng&) { return kReachOfStuck_m; }), kBeamsOfStuck,
                             kReachOfStuck_m)
                  .empty());
}

// Along a wall half of the beams may say the same without noise: that tells of the place.
TEST(StuckBeams, WhereMostDoNotChangeNothingIsSaid) {
  std::vector<double> range_m = StuckReadings([](double range, Rng&) { return range; });
  for (std::size_t i = 0; i < range_m.size(); ++i)
    if (i % kBeamsOfStuck != 0) range_m[i] = 1;
  EXPECT_TRUE(FindStuckBeams(range_m, kBeamsOfStuck, kReachOfStuck_m).empty());
}

TEST(StuckBeams, TheWarningNamesRobotSensorAndBeam) {
  Blob log;
  log.Put("robots", Array::Texts({"anna"}));
  std::vector<double> time_s, heading_rad;
  for (std::size_t s = 0; s < kScansOfStuck; ++s) time_s.push_back(0.2 * static_cast<double>(s));
  for (std::size_t b = 0; b < kBeamsOfStuck; ++b) heading_rad.push_back(static_cast<double>(b) * M_PI / 4);
  log.PutVector("robot/0/sonar/time_s", time_s);
  log.Put("robot/0/sonar/range_m", Array::Of<double>({kScansOfStuck, kBeamsOfStuck},
                                                     StuckReadings([](double, Rng&) { return 1.234; })));
  log.PutVector("robot/0/sonar/beam_heading_rad", heading_rad);
  const std::vector<std::string> warnings = StuckBeamsOf(log);
  ASSERT_EQ(warnings.size(), 1U);
  ExpectContains(warnings[0], "robot 'anna', its sonar: 1 of 8 beams always measure the same");
  ExpectContains(warnings[0], "3 (which points 135 degrees from ahead; 1.234 m)");
  EXPECT_TRUE(StuckBeamsOf(log.Without("robot/0/sonar/range_m")).empty());
  const TestFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", log).ok());
  ExpectContains(InspectText(Inspect(folder / "a.h5").value()), warnings[0]);
}

}  // namespace
}  // namespace cairn::datasets
