#include "pipelines/evidence_map/cone_counts.h"

#include <gtest/gtest.h>

#include "pipelines/evidence_map/testing.h"

namespace cairn::evidence_map {
namespace {

const double kNothing = std::nan("");
const GridBox kGrid{-1, -1, 0.1, 30, 20};

Totals Whole(const RangeScans& scans, const ConeModel& model, bool use_no_return = true) {
  Untroubled progress;
  Totals totals{std::vector<std::int64_t>(600), std::vector<std::int64_t>(600)};
  AddTo(kGrid, ToBlob(CountCones(scans, kGrid, model, use_no_return, progress)), &totals);
  return totals;
}

std::size_t At(double x, double y) {
  return static_cast<std::size_t>(kGrid.RowOf(y) * kGrid.columns + kGrid.ColumnOf(x));
}

// A cone of 30 degrees along x from (0.05, 0.05), 1.5 m long: that sees centres at y = 0.05 + 0.1 n.
TEST(CountCones, FreeBeforeTheRangeOccupiedAtItNothingBeyond) {
  const Totals totals = Whole(OneBeam({{0.05, 0.05, 0}}, {1.5}, 0.5236, 4), {0.1, false});
  EXPECT_EQ(totals.free[At(0.55, 0.05)], kWhole);
  EXPECT_EQ(totals.free[At(1.35, 0.05)], kWhole);
  EXPECT_EQ(totals.free[At(1.45, 0.05)], 0);  // 1.4 m away, within 0.15 m of the range
  EXPECT_EQ(totals.occupied[At(1.45, 0.05)], kWhole);
  EXPECT_EQ(totals.occupied[At(1.65, 0.05)], kWhole);
  EXPECT_EQ(totals.occupied[At(1.75, 0.05)], 0);
  EXPECT_EQ(totals.occupied[At(1.55, 0.35)], kWhole);  // 11 degrees off
  EXPECT_EQ(totals.occupied[At(1.55, 0.55)], 0);       // 18 degrees
  EXPECT_EQ(totals.free[At(-0.15, 0.05)], 0);          // behind
}

TEST(CountCones, GradedSaysLessOffTheAxisAndFarAway) {
  const Totals totals = Whole(OneBeam({{0.05, 0.05, 0}}, {1.5}, 0.5236, 4), {0.1, true});
  EXPECT_EQ(totals.free[At(0.55, 0.05)], std::lround(256 * (1 - 0.5 * 0.5 / 2.25)));
  EXPECT_EQ(totals.occupied[At(1.55, 0.05)], 256);
  EXPECT_EQ(totals.occupied[At(1.45, 0.05)], std::lround(256 * (1 - 0.01 / 0.0225)));
  const double angle = std::atan2(0.3, 1.5), beyond = std::hypot(0.3, 1.5) - 1.5;
  EXPECT_EQ(totals.occupied[At(1.55, 0.35)],
            std::lround(256 * (1 - angle * angle / 0.2618 / 0.2618) * (1 - beyond * beyond / 0.0225)));
}

TEST(CountCones, NoAnswerIsFreeAsFarAsTheSensorReachesOrSaysNothing) {
  const RangeScans scans = OneBeam({{0.05, 0.05, 0}}, {kNothing}, 0.5236, 1.2);
  const Totals free = Whole(scans, {0.1, false});
  EXPECT_EQ(free.free[At(1.25, 0.05)], kWhole);
  EXPECT_EQ(free.free[At(1.35, 0.05)], 0);
  EXPECT_EQ(free.occupied, std::vector<std::int64_t>(600, 0));
  EXPECT_EQ(Whole(scans, {0.1, false}, false).free, std::vector<std::int64_t>(600, 0));
}

TEST(CountCones, PartsAddUpToTheWholeAndHeldOutScansSayNothing) {
  RangeScans scans =
      OneBeam({{0.05, 0.05, 0}, {0.3, -0.4, 1.2}, {0.5, 0.2, 3}}, {1.5, 0.7, kNothing}, 0.3, 2);
  const Totals whole = Whole(scans, {0.1, true});
  Untroubled progress;
  Totals sum{std::vector<std::int64_t>(600), std::vector<std::int64_t>(600)};
  for (std::size_t s = 0; s < 3; ++s)
    AddTo(kGrid, ToBlob(CountCones(ScansFrom(scans, s, 1), kGrid, {0.1, true}, true, progress)), &sum);
  EXPECT_EQ(sum.free, whole.free);
  EXPECT_EQ(sum.occupied, whole.occupied);
  scans.held_out.assign(3, 1);
  EXPECT_EQ(Whole(scans, {0.1, true}).free, std::vector<std::int64_t>(600, 0));
}

}  // namespace
}  // namespace cairn::evidence_map
