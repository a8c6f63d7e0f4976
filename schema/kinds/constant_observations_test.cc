#include "schema/kinds/constant_observations.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn {
namespace {

Blob SawAt(const std::vector<double>& range_m, const std::vector<double>& bearing_rad) {
  Blob log;
  log.Put("robots", Array::Texts({"one", "anna"}));
  log.PutVector("robot/1/observations/range_m", range_m);
  log.PutVector("robot/1/observations/bearing_rad", bearing_rad);
  return log;
}

std::vector<double> Rising(int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(0.1 * i);
  return values;
}

TEST(ConstantObservations, NameRobotColumnAndValue) {
  const auto bearings = ConstantObservationsOf(SawAt(Rising(20), std::vector<double>(20, 0.0)));
  ASSERT_EQ(bearings.size(), 1U);
  EXPECT_EQ(bearings[0],
            "robot 'anna': all bearings of its observations of landmarks are 0 rad: was the column filled "
            "in, or another one written there?");
  const auto ranges = ConstantObservationsOf(SawAt(std::vector<double>(20, 2.5), Rising(20)));
  ASSERT_EQ(ranges.size(), 1U);
  EXPECT_NE(ranges[0].find("all ranges of its observations of landmarks are 2.5 m"), std::string::npos)
      << ranges[0];
  EXPECT_EQ(ConstantObservationsOf(SawAt(std::vector<double>(20, 2.5), std::vector<double>(20, 0.1))).size(),
            2U);
}

TEST(ConstantObservations, FewOrDifferentOnesAreNone) {
  EXPECT_TRUE(ConstantObservationsOf(SawAt(Rising(20), Rising(20))).empty());
  EXPECT_TRUE(ConstantObservationsOf(SawAt(Rising(19), std::vector<double>(19, 0.0))).empty());
  const std::vector<double> contacts(40, std::nan(""));
  EXPECT_TRUE(ConstantObservationsOf(SawAt(contacts, contacts)).empty());
  EXPECT_TRUE(ConstantObservationsOf(Blob()).empty());
}

}  // namespace
}  // namespace cairn
