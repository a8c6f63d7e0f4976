#include "schema/headings.h"

#include <gtest/gtest.h>

#include <vector>

namespace cairn {
namespace {

TEST(Headings, AreComparedAcrossTheirWrap) {
  EXPECT_NEAR(TurnBetween(3.0, -3.0), 0.2832, 1e-4);
  EXPECT_NEAR(TurnBetween(0.0, 3.0), 3.0, 1e-12);
  EXPECT_NEAR(TurnBetween(-20.0, -20.0 + 8 * 3.14159265358979), 0.0, 1e-9);
  EXPECT_TRUE(FaceAlike(3.0, -2.0));
  EXPECT_FALSE(FaceAlike(0.0, 3.0));
}

TEST(Headings, FaceOneWayUntilOnePointsBack) {
  EXPECT_TRUE(AllFaceOneWay({}));
  EXPECT_TRUE(AllFaceOneWay(std::vector<double>{3.0, -3.1, 2.5, -2.4}));
  EXPECT_FALSE(AllFaceOneWay(std::vector<double>{0.1, -0.1, 0.2, 3.0}));
}

}  // namespace
}  // namespace cairn
