#include "schema/kinds/odometry_steps.h"

#include <gtest/gtest.h>

#include <numbers>

namespace cairn {
namespace {

TEST(OdometrySteps, TheChordOfAnArcIsShorter) {
  EXPECT_EQ(ChordOfArc(2, 0), 2);
  EXPECT_NEAR(ChordOfArc(std::numbers::pi, std::numbers::pi), 2, 1e-12);  // half a circle of radius 1
  EXPECT_NEAR(ChordOfArc(-std::numbers::pi, -std::numbers::pi), -2, 1e-12);
}

TEST(OdometrySteps, AStepTurnsAndGoesAndIsAloneAtItsTime) {
  kinds::Log::Odometry odometry;
  odometry.time_s = std::vector<double>{0, 1, 2, 2, 3, 4};
  odometry.turn_rad = std::vector<double>{0, 0.2, 0.1, 0.1, 0.3, 0};
  odometry.forward_m = std::vector<double>{0, 0.5, 1, 0, 0, 1};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(IsStep(odometry.time_s.values(), odometry.turn_rad.values(), odometry.forward_m.values(), i),
              i == 1)
        << i;
  EXPECT_NEAR(HalfStep_m(odometry), 0.25 * 0.04 / (0.04 + 0.01 + 0.01 + 0.09), 1e-12);
}

TEST(OdometrySteps, WhereNothingTurnsThereIsNoHalfStep) {
  kinds::Log::Odometry odometry;
  odometry.time_s = std::vector<double>{0, 1};
  odometry.turn_rad = std::vector<double>{0, 0};
  odometry.forward_m = std::vector<double>{0, 1};
  EXPECT_EQ(HalfStep_m(odometry), 0);
}

}  // namespace
}  // namespace cairn
