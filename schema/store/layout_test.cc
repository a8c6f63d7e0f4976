#include "schema/store/layout.h"

#include <gtest/gtest.h>

namespace cairn::store {
namespace {

TEST(Layout, UnitsComeFromTheEndOfTheName) {
  EXPECT_EQ(UnitOf("robot/0/odometry/time_s"), "s");
  EXPECT_EQ(UnitOf("map/landmark_covariance_m2"), "m^2");
  EXPECT_EQ(UnitOf("noise/heading_drift_rad_per_m"), "rad/m");
  EXPECT_EQ(UnitOf("noise/heading_walk_rad_per_sqrt_m"), "rad/sqrt(m)");
  EXPECT_EQ(UnitOf("v_mps"), "m/s");
  EXPECT_EQ(UnitOf("omega_radps"), "rad/s");
  EXPECT_EQ(UnitOf("speed_m/count"), "1");
  EXPECT_EQ(UnitOf("robots"), "1");
}

TEST(Layout, ChunksCoverTheArrayInPiecesOfAboutAMebibyte) {
  EXPECT_EQ(ChunksOf({100, 7}, 8), (Shape{100, 7}));
  for (const Shape& shape :
       {Shape{1000000}, Shape{3, 1000, 1000}, Shape{5, 400000}, Shape{131073}, Shape{2, 3, 131073}}) {
    const Shape chunks = ChunksOf(shape, 8);
    std::int64_t bytes = 8;
    for (std::size_t axis = 0; axis < shape.size(); ++axis) {
      EXPECT_GE(chunks[axis], 1);
      EXPECT_LE(chunks[axis], shape[axis]);
      bytes *= chunks[axis];
    }
    EXPECT_LE(bytes, 1 << 20);
    EXPECT_GE(bytes, 1 << 18);
  }
}

TEST(Layout, DeflateIsForLargeArraysOfZeros) {
  EXPECT_FALSE(DeflatePays(Array::Vector(std::vector<double>(100, 0))));
  EXPECT_TRUE(DeflatePays(Array::Vector(std::vector<double>(100000, 0))));
  EXPECT_FALSE(DeflatePays(Array::Vector(std::vector<double>(100000, 0.1))));
}

TEST(UnitContradicts, AnotherOneThanTheNamesAlone) {
  EXPECT_TRUE(UnitContradicts("robot/0/odometry/forward_m", "cm"));
  EXPECT_TRUE(UnitContradicts("robot/0/odometry/turn_rad", "deg"));
  EXPECT_TRUE(UnitContradicts("robot/0/odometry/time_s", "ms"));
  for (const char* same : {"", "1", "m", "metres"})
    EXPECT_FALSE(UnitContradicts("robot/0/odometry/forward_m", same)) << same;
  EXPECT_FALSE(UnitContradicts("robot/0/observations/landmark", "cm")) << "a name without a unit";
}

}  // namespace
}  // namespace cairn::store
