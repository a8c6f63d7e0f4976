#include "pipelines/common/beam_cells.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "schema/rng.h"

namespace cairn {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<std::int64_t> OnRay(const GridBox& box, const Pose& from, double length_m) {
  std::vector<std::int64_t> cells;
  WalkRay(box, from, length_m, [&](std::int64_t cell, double, double) { cells.push_back(cell); });
  return cells;
}

TEST(WalkRay, MeetsTheCellsOfARowOrOfADiagonalInOrder) {
  const GridBox box{0, 0, 1, 4, 4};
  EXPECT_EQ(OnRay(box, {0.5, 1.5, 0}, 2.2), (std::vector<std::int64_t>{4, 5, 6}));
  EXPECT_EQ(OnRay(box, {3.5, 2.5, kPi}, 1.2), (std::vector<std::int64_t>{11, 10}));
  EXPECT_EQ(OnRay(box, {0.5, 0.6, kPi / 4}, 2.0), (std::vector<std::int64_t>{0, 4, 5, 9}));
  EXPECT_EQ(OnRay(box, {-2, 0.5, 0}, 3.5), (std::vector<std::int64_t>{0, 1}));  // from outside
  EXPECT_TRUE(OnRay(box, {-2, 0.5, kPi}, 30).empty());
  EXPECT_TRUE(OnRay(box, {2, 2, 0}, 0).empty());
}

// An oracle that shares nothing with the walk: points along the ray, closely.
TEST(WalkRay, CoversTheRayWithoutGapsAsSampledPointsDo) {
  const GridBox box{-3, -2, 0.25, 30, 20};
  Rng rng(7);
  for (int trial = 0; trial < 300; ++trial) {
    const Pose from{-4 + 9 * rng.Uniform(), -3 + 7 * rng.Uniform(), kPi * (2 * rng.Uniform() - 1)};
    const double length_m = 6 * rng.Uniform();
    std::set<std::int64_t> walked;
    double covered_m = 0;
    WalkRay(box, from, length_m, [&](std::int64_t cell, double enter_m, double leave_m) {
      EXPECT_TRUE(walked.insert(cell).second) << "twice";
      EXPECT_GE(leave_m, enter_m);
      covered_m += leave_m - enter_m;
    });
    double inside_m = 0;
    constexpr double kStepM = 0.002;
    for (double t = kStepM / 2; t < length_m; t += kStepM) {
      const Pose at = Compose(from, {t, 0, 0});
      const std::int64_t i = box.ColumnOf(at.x_m), j = box.RowOf(at.y_m);
      if (!box.Holds(i, j)) continue;
      inside_m += kStepM;
      EXPECT_TRUE(walked.contains(j * box.columns + i)) << trial << " at " << t;
    }
    EXPECT_NEAR(covered_m, inside_m, 2.1 * kStepM) << trial;
  }
}

TEST(BeamCells, OfAConeAreThoseWhoseCentreIsInItByDistanceAndItsAxis) {
  const GridBox box{-2, -2, 0.1, 60, 40};
  const Pose from{0.03, 0.02, 0.4};
  constexpr double kOpeningRad = 0.26, kLengthM = 1.7;
  std::vector<BeamCell> cells;
  BeamCells(box, from, kOpeningRad, kLengthM, &cells);
  std::set<std::int64_t> expected;
  for (std::int64_t cell = 0; cell < box.cells(); ++cell) {
    const double dx = box.CentreX(cell % box.columns) - from.x_m,
                 dy = box.CentreY(cell / box.columns) - from.y_m;
    if (std::hypot(dx, dy) <= kLengthM && std::abs(WrapAngle(std::atan2(dy, dx) - 0.4)) <= kOpeningRad / 2)
      expected.insert(cell);
  }
  ASSERT_GT(expected.size(), 20U);
  for (const std::int64_t cell : OnRay(box, from, kLengthM)) expected.insert(cell);
  std::set<std::int64_t> found;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    found.insert(cells[k].cell);
    EXPECT_GE(cells[k].distance_m, k > 0 ? cells[k - 1].distance_m : 0);
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(found.size(), cells.size());
}

TEST(BeamCells, OfARayAreItsCellsByDistanceAlongIt) {
  const GridBox box{0, 0, 0.5, 10, 10};
  std::vector<BeamCell> cells;
  BeamCells(box, {0.25, 0.25, kPi / 2}, 0, 1.2, &cells);
  ASSERT_EQ(cells.size(), 3U);
  EXPECT_EQ(cells[2].cell, 20);
  EXPECT_DOUBLE_EQ(cells[2].distance_m, 1.0);
}

}  // namespace
}  // namespace cairn
