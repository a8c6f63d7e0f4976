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

// Of many observations of a robot that stands some err by more than those of one that moves a little.
TEST(OdometryHoles, AreNoneWhereFewOfManyObservationsErr) {
  std::vector<double> range_m{8, 8.1, 7.9, 8, 7.4, 8.1, 8.6, 8, 8};
  EXPECT_TRUE(OdometryHolesOf(LogThatSees(0, range_m)).empty());
  range_m[5] = 7;
  EXPECT_EQ(OdometryHolesOf(LogThatSees(0, range_m)).size(), 1U) << "three of eight";
}

// A row and an observation of range and bearing each second or oftener, but none from 20 to 30 s: the last
// before and the first after see a landmark at these ranges. `after_mps`: how fast it goes on.
Blob LogThatPauses(double before_m, double after_m, double travelled_m = 0.02, double after_mps = 0.5) {
  Blob log = LogWithHole(travelled_m, {});
  std::vector<double> observed_s, range, forward;
  for (int i = 0; i <= 60; ++i) {
    if (i > 19 && i < 31) continue;
    observed_s.push_back(i + 0.5);
    range.push_back(i <= 19 ? before_m : after_m);
  }
  for (std::size_t i = 0; i < log.Get<double>("robot/0/odometry/forward_m").size(); ++i)
    forward.push_back(i > 201 ? 0.1 * after_mps : log.Get<double>("robot/0/odometry/forward_m")[i]);
  log.PutVector("robot/0/odometry/forward_m", forward);
  log.PutVector("robot/0/observations/time_s", observed_s);
  log.PutVector("robot/0/observations/range_m", range);
  log.PutVector("robot/0/observations/bearing_rad", std::vector<double>(range.size(), 0.1));
  log.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>(range.size(), -1));
  return log;
}

TEST(OdometryHoles, WhereNeitherWasRecordedAreNamedIfItSeesOtherThingsAfter) {
  const std::vector<std::string> texts = OdometryHolesOf(LogThatPauses(8, 3));
  ASSERT_EQ(texts.size(), 1U);
  ExpectSays(texts.front(),
             "robot 'anna': its log lacks 10 s from 20 s on (rows are 0.1 s apart), in which it "
             "moved, for it sees other things after (was the recorder paused?); of what it "
             "travelled some 5 m are missing");
  const std::vector<OdometryHole> holes = FindOdometryHoles(LogThatPauses(8, 3));
  ASSERT_EQ(holes.size(), 1U);
  EXPECT_NEAR(holes[0].begin_s, 20, 1e-9);
  EXPECT_NEAR(holes[0].length_s, 10, 1e-9);
  EXPECT_NEAR(holes[0].missing_m, 4.98, 0.01);
  EXPECT_EQ(holes[0].observations, 0);
}

TEST(OdometryHoles, AreNoneWhereNothingWasRecordedAndItStoodOrARowTells) {
  EXPECT_TRUE(FindOdometryHoles(LogThatPauses(8, 7.8)).empty()) << "it sees what it saw";
  EXPECT_TRUE(FindOdometryHoles(LogThatPauses(8, 3, 5)).empty()) << "the row after says how far it went";
  EXPECT_TRUE(FindOdometryHoles(LogThatPauses(8, 3, 0.02, 0.01)).empty()) << "it came to rest";
}

TEST(OdometryHoles, AreNoneWhereItStoodStillOrObservedNothing) {
  EXPECT_TRUE(OdometryHolesOf(LogWithHole(0, {22, 25})).empty());
  EXPECT_TRUE(OdometryHolesOf(LogWithHole(5, {19, 31})).empty());
  EXPECT_TRUE(OdometryHolesOf(Blob()).empty());
}

}  // namespace
}  // namespace cairn
