#include "datasets/common/ring_turn_doubts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "datasets/inspect/inspect.h"
#include "datasets/testing.h"
#include "schema/rng.h"
#include "schema/store/blob_file.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kRingBeams = 16;

// From (x, 2) in a room of 6 by 4 m.
double ToRoomM(double x_m, double towards_rad) {
  const double ux = std::cos(towards_rad), uy = std::sin(towards_rad);
  return std::min((ux > 0 ? 6 - x_m : x_m) / std::max(std::abs(ux), 1e-9), 2 / std::max(std::abs(uy), 1e-9));
}

// A robot drives to and fro in the room; its ring is turned by `turned_rad` from how the log has it.
Blob RingLog(double turned_rad, std::size_t scans = 300, bool has_odometry = true) {
  Rng rng(2);
  std::vector<double> time_s, forward_m, x_m, heading_rad, range_m;
  for (std::size_t b = 0; b < kRingBeams; ++b)
    heading_rad.push_back(WrapAngle(static_cast<double>(b) * 2 * M_PI / static_cast<double>(kRingBeams)));
  for (std::size_t s = 0; s < scans; ++s) {
    time_s.push_back(0.5 * static_cast<double>(s));
    forward_m.push_back(s == 0 ? 0 : (s / 20) % 2 == 0 ? 0.2 : -0.2);
    x_m.push_back(s == 0 ? 1 : x_m.back() + forward_m.back());
    for (const double heading : heading_rad)
      range_m.push_back(ToRoomM(x_m.back(), heading + turned_rad) + 0.01 * rng.Normal());
  }
  Blob log;
  log.Put("robots", Array::Texts({"anna"}));
  const std::string path = has_odometry ? "robot/0/odometry/" : "robot/0/poses/", sonar = "robot/0/sonar/";
  log.PutVector(path + "time_s", time_s);
  if (has_odometry) {
    log.PutVector(path + "turn_rad", std::vector<double>(scans, 0.0));
    log.PutVector(path + "forward_m", forward_m);
  } else {
    log.PutVector(path + "x_m", x_m);
    log.PutVector(path + "y_m", std::vector<double>(scans, 2.0));
    log.PutVector(path + "heading_rad", std::vector<double>(scans, 0.0));
  }
  log.PutVector(sonar + "time_s", time_s);
  log.Put(sonar + "range_m", Array::Of<double>({static_cast<std::int64_t>(scans), kRingBeams}, range_m));
  log.PutVector(sonar + "beam_heading_rad", heading_rad);
  return log;
}

TEST(RingTurnDoubts, WhatComesNearerTellsWhichBeamsPointAhead) {
  for (const bool has_odometry : {true, false}) {
    for (const double turned_deg : {0, 45, 90, -90, 135}) {
      const auto log = Read<kinds::Log>(RingLog(turned_deg * M_PI / 180, 300, has_odometry));
      const auto turn_rad = RingTurnRad(log.robot[0], log.robot[0].sensors[0]);
      ASSERT_TRUE(turn_rad) << turned_deg;
      EXPECT_NEAR(*turn_rad * 180 / M_PI, turned_deg, 5) << has_odometry;
    }
  }
}

TEST(RingTurnDoubts, TheWarningNamesRobotSensorAndAngle) {
  EXPECT_TRUE(RingTurnDoubtsOf(RingLog(0)).empty());
  EXPECT_TRUE(RingTurnDoubtsOf(RingLog(0.4)).empty()) << "a ring whose beams are 22 degrees apart";
  const std::vector<std::string> doubts = RingTurnDoubtsOf(RingLog(M_PI / 2));
  ASSERT_EQ(doubts.size(), 1U);
  ExpectContains(doubts[0], "robot 'anna', its sonar");
  ExpectContains(doubts[0],
                 "turned by about 90 degrees from how the log has it (robot/0/sonar/beam_heading_rad)");
  const TestFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", RingLog(M_PI / 2)).ok());
  ExpectContains(InspectText(Inspect(folder / "a.h5").value()), doubts[0]);
}

TEST(RingTurnDoubts, WhatIsShortOrIncompleteTellsNothing) {
  const Blob log = RingLog(M_PI / 2);
  EXPECT_TRUE(RingTurnDoubtsOf(RingLog(M_PI / 2, 20)).empty());
  EXPECT_TRUE(RingTurnDoubtsOf(log.Without("robot/0/odometry/")).empty());
  EXPECT_TRUE(RingTurnDoubtsOf(log.Without("robot/0/sonar/range_m")).empty());
  Blob on_turret = log;
  on_turret.PutVector("robot/0/sonar/turret_rad", std::vector<double>(300, 0.0));
  EXPECT_TRUE(RingTurnDoubtsOf(on_turret).empty());
}

}  // namespace
}  // namespace cairn::datasets
