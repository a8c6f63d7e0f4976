#include "datasets/common/odometry_holes.h"

#include <gtest/gtest.h>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

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
  ExpectContains(texts.front(), "robot 'anna': its odometry lacks 10 s from 20 s on (rows are 0.1 s apart)");
  ExpectContains(texts.front(), "observed 2 times");
}

TEST(OdometryHoles, AreNoneWhereItStoodStillOrObservedNothing) {
  EXPECT_TRUE(OdometryHolesOf(LogWithHole(0, {22, 25})).empty());
  EXPECT_TRUE(OdometryHolesOf(LogWithHole(5, {19, 31})).empty());
  EXPECT_TRUE(OdometryHolesOf(Blob()).empty());
}

}  // namespace
}  // namespace cairn::datasets
