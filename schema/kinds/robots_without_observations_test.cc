#include "schema/kinds/robots_without_observations.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(RobotsWithoutObservations, AreNamedWhereOthersHaveObserved) {
  Blob log;
  log.Put("robots", Array::Texts({"anna", "otto"}));
  for (const char* robot : {"robot/0/", "robot/1/"}) {
    log.PutVector(std::string(robot) + "odometry/time_s", std::vector<double>{1, 2});
    log.PutVector(std::string(robot) + "observations/time_s", std::vector<double>{});
  }
  EXPECT_TRUE(RobotsWithoutObservationsOf(log).empty());
  log.PutVector("robot/0/observations/time_s", std::vector<double>{1.5});
  const std::vector<std::string> texts = RobotsWithoutObservationsOf(log);
  ASSERT_EQ(texts.size(), 1U);
  EXPECT_NE(texts[0].find("robot 'otto' has no observations"), std::string::npos) << texts[0];
  EXPECT_NE(texts[0].find("leave its rows out of the odometry"), std::string::npos) << texts[0];
  log.PutVector("robot/1/observations/time_s", std::vector<double>{1.5});
  EXPECT_TRUE(RobotsWithoutObservationsOf(log).empty());
  EXPECT_TRUE(RobotsWithoutObservationsOf(Blob()).empty());
}

}  // namespace
}  // namespace cairn
