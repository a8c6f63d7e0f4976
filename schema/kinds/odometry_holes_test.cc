#include "schema/kinds/odometry_holes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn {
namespace {

void ExpectSays(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

// A row each 0.1 s for 60 s, but for those between 20 and 30 s; the row at 30 s goes `travelled_m`.
Blob LogWithHole(double travelled_m, const std::vector<double>& observed_s) {
  std::vector<double> time, turn, forward;
  for (int i = 0; i <= 600; ++i) {
    if (i > 200 && i < 300) continue;
    time.push_back(0.1 * i);
    turn.push_back(0);
    forward.push_back(i == 300 ? travelled_m : 0.05);
  }
  Blob log;
  log.Put("robots", Array::Texts({"anna"}));
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  log.PutVector("robot/0/observations/time_s", observed_s);
  return log;
}

TEST(OdometryHoles, WhereTheRobotMovedAndObservedAreNamed) {
  const std::vector<std::string> texts = OdometryHolesOf(LogWithHole(5, {19, 22, 25, 31}));
  ASSERT_EQ(texts.size(), 1U);
  ExpectSays(texts.front(), "robot 'anna': its odometry lacks 10 s from 20 s on (rows are 0.1 s apart)");
  ExpectSays(texts.front(), "observed 2 times");
}

// What is seen of a landmark in the hole, from start to end.
Blob LogThatSees(double travelled_m, const std::vector<double>& range_m) {
  std::vector<double> observed_s;
  for (std::size_t i = 0; i < range_m.size(); ++i) observed_s.push_back(21 + static_cast<double>(i));
  Blob log = LogWithHole(travelled_m, observed_s);
  log.PutVector("robot/0/observations/range_m", range_m);
  log.PutVector("robot/0/observations/bearing_rad", std::vector<double>(range_m.size(), 0.1));
  log.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>(range_m.size(), 0));
  return log;
}

TEST(OdometryHoles, WhoseMotionNoRowTellsAreNamed) {
  const std::vector<std::string> texts = OdometryHolesOf(LogThatSees(0.04, {8, 7, 6, 5}));
  ASSERT_EQ(texts.size(), 1U);
  ExpectSays(texts.front(), "lacks 10 s from 20 s on");
  ExpectSays(texts.front(), "of what it travelled some 5 m are missing");
  // Where no landmark is seen twice, others are.
  Blob others = LogThatSees(0.04, {8, 8, 8});
  others.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>{0, 1, 2});
  EXPECT_EQ(OdometryHolesOf(others).size(), 1U);
  // A button pressed where another was.
  Blob pressed = LogThatSees(0.04, std::vector<double>(2, std::nan("")));
  EXPECT_EQ(OdometryHolesOf(pressed).size(), 0U);
  pressed.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>{0, 1});
  EXPECT_EQ(OdometryHolesOf(pressed).size(), 1U);
}

TEST(OdometryHoles, AreNoneWhereALandmarkIsSeenWhereItWas) {
  EXPECT_TRUE(OdometryHolesOf(LogThatSees(0.04, {8, 8.1, 7.9})).empty());
  EXPECT_TRUE(OdometryHolesOf(LogThatSees(0.3, {8, 8.1, 7.9})).empty());
  EXPECT_EQ(OdometryHolesOf(LogThatSees(5, {8, 8.1, 7.9})).size(), 1U);
}

TEST(OdometryHoles, AreNoneWhereItStoodStillOrObservedNothing) {
  EXPECT_TRUE(OdometryHolesOf(LogWithHole(0, {22, 25})).empty());
  EXPECT_TRUE(OdometryHolesOf(LogWithHole(5, {19, 31})).empty());
  EXPECT_TRUE(OdometryHolesOf(Blob()).empty());
}

}  // namespace
}  // namespace cairn
