#include "pipelines/landmark_map/model/odometry_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "schema/rng.h"

namespace cairn::landmark_map {
namespace {

constexpr double kPi = std::numbers::pi;

IncrementSums Headings(const std::vector<double>& latest_first, double increment_m) {
  IncrementSums sums;
  for (const double heading : latest_first) sums.AddHeading(heading, increment_m);
  return sums;
}

MotionNoise Nominal() {
  MotionNoise nominal;
  nominal.heading_drift_rad_per_m = 0.02;
  nominal.heading_walk_rad_per_sqrt_m = 0.1;
  nominal.turn_ratio = 0.05;
  return nominal;
}

// Corrections 0, -0.1, -0.2 rad over 2 motion increments of 5 m: odometry drifts by +0.02 rad/m. Prior
// variance 4e-4, that of the walk's mean 0.1^2 / 10 m = 1e-3: the drift found is 4 / 14 of what was seen.
TEST(FitDrift, WeighsWhatHeadingsDidAgainstThePriorByHand) {
  const IncrementSums sums = Headings({-0.2, -0.1, 0.0}, 5.0);
  EXPECT_NEAR(sums.path_m(), 10.0, 1e-12);
  EXPECT_NEAR(sums.turned_rad(), -0.2, 1e-12);
  EXPECT_NEAR(FitDrift(sums, Nominal(), 0.0), 0.02 * 4.0 / 14.0, 1e-12);
  // What was taken off before counts too.
  EXPECT_NEAR(FitDrift(sums, Nominal(), 0.01), 0.03 * 4.0 / 14.0, 1e-12);
  MotionNoise sure = Nominal();
  sure.heading_walk_rad_per_sqrt_m = 0.0;
  EXPECT_NEAR(FitDrift(sums, sure, 0.0), 0.02, 1e-12);
}

TEST(FitDrift, CountsTurnsAcrossTheEndOfTheCircle) {
  EXPECT_NEAR(Headings({kPi - 0.05, kPi - 0.01, -kPi + 0.03, -kPi + 0.07}, 1.0).turned_rad(), -0.12, 1e-12);
}

TEST(FitDrift, LeavesARobotAloneThatHasNotMoved) {
  EXPECT_EQ(FitDrift(Headings({0.1}, 0.0), Nominal(), 0.3), 0.3);
  MotionNoise exact = Nominal();
  exact.heading_drift_rad_per_m = exact.heading_walk_rad_per_sqrt_m = 0.0;
  EXPECT_EQ(FitDrift(Headings({0.2, 0.0}, 1.0), exact, 0.3), 0.3);
}

TEST(IncrementSums, SlicesJoinToTheWhole) {
  const MotionNoise widths = Nominal();
  const std::vector<double> headings = {0.5, 0.3, 0.4, 0.1, 0.2};
  IncrementSums whole, late, early;
  for (int i = 0; i < 5; ++i) {
    whole.AddHeading(headings[i], 2.0);
    (i < 2 ? late : early).AddHeading(headings[i], 2.0);
    const MotionIncrement increment{2.0, 0.0, 2.0, 0.1 * i};
    const HalfTurn half{0.01, 0.02 * i, 0.004};
    whole.AddIncrement(increment, half, widths);
    (i < 2 ? late : early).AddIncrement(increment, half, widths);
  }
  Blob blob;
  PutFields("increments/", early, &blob);
  IncrementSums joined;
  joined.Join(late, 7.0);  // nothing before: its own link is not there
  joined.Join(FieldsIn<IncrementSums>("increments/", blob), 2.0);
  EXPECT_NEAR(joined.turned_rad(), whole.turned_rad(), 1e-12);
  EXPECT_NEAR(joined.path_m(), 8.0, 1e-12);
  EXPECT_NEAR(whole.path_m(), 8.0, 1e-12);
  EXPECT_NEAR(joined.walk().squares, whole.walk().squares, 1e-12);
  EXPECT_NEAR(joined.walk().known, whole.walk().known, 1e-12);
  EXPECT_NEAR(joined.turn().squares, whole.turn().squares, 1e-12);
  EXPECT_GT(whole.turn().squares, 0.0);
}

// Half of the motion increment's variance comes from the walk (0.1^2 * 1 m), half from the turn (0.05 * 2
// rad). The half turn's prior variance is 0.01; the data put it at 0.2 with variance 0.0025: three quarters
// are told.
TEST(IncrementSums, SharesALegsErrorAmongItsSourcesByHand) {
  IncrementSums sums;
  const MotionIncrement increment{1.0, 0.0, 1.0, 2.0};
  sums.AddIncrement(increment, {0.01, 0.2, 0.0025}, Nominal());
  EXPECT_NEAR(sums.walk().squares, 2.0 * 4.0 * 0.5, 1e-12);
  EXPECT_NEAR(sums.walk().known, 2.0 * 0.75 * 0.5, 1e-12);
  EXPECT_NEAR(sums.turn().squares, 4.0, 1e-12);
  EXPECT_NEAR(sums.turn().known, 0.75, 1e-12);
  // Two places are possible, far to the left and far to the right: a large error, though its mean is zero.
  IncrementSums wide;
  wide.AddIncrement(increment, {0.01, 0.0, 0.05}, Nominal());
  EXPECT_NEAR(wide.walk().squares, 4.0, 1e-12);
  EXPECT_EQ(wide.walk().known, 0.0);
  // A kernel without error, and one without data.
  IncrementSums none;
  none.AddIncrement(increment, {}, Nominal());
  none.AddIncrement(increment, {0.01, 0.0, 0.01}, Nominal());
  EXPECT_EQ(none.walk().squares, 0.0);
  EXPECT_EQ(none.walk().known, 0.0);
}

TEST(FitWidths, WithoutDataNothingChanges) {
  std::vector<OdometryFit> fits(2, OdometryFit::Of(Nominal()));
  FitWidths(std::vector<IncrementSums>(2), Nominal(), &fits);
  for (const OdometryFit& fit : fits) {
    EXPECT_NEAR(fit.heading_walk_rad_per_sqrt_m, 0.1, 1e-12);
    EXPECT_NEAR(fit.turn_ratio, 0.05, 1e-12);
  }
}

// 100 straight motion increments whose errors, seen exactly, are 1.5 times the nominal: 20 motion increments'
// prior holds the mean over robots to (20 + 200 * 2.25) / 220, and 20 more hold the one robot's own to it.
TEST(FitWidths, WeighsThePriorByHandAndLendsWhatOneRobotShowedToTheOther) {
  IncrementSums sums;
  for (int i = 0; i < 100; ++i)
    sums.AddIncrement({1.0, 0.0, 1.0, 0.0}, {0.005, 0.15 / std::sqrt(2.0), 0.0}, Nominal());
  EXPECT_NEAR(sums.walk().known, 200.0, 1e-9);
  std::vector<OdometryFit> fits(2, OdometryFit::Of(Nominal()));
  FitWidths({sums, IncrementSums()}, Nominal(), &fits);
  const double mean = (20.0 + 200.0 * 2.25) / 220.0;
  EXPECT_NEAR(fits[0].heading_walk_rad_per_sqrt_m, 0.1 * std::sqrt((20.0 * mean + 200.0 * 2.25) / 220.0),
              1e-9);
  EXPECT_NEAR(fits[1].heading_walk_rad_per_sqrt_m, 0.1 * std::sqrt(mean), 1e-9);
  EXPECT_NEAR(fits[1].turn_ratio, 0.05, 1e-12);
}

TEST(FitWidths, AtMostDoublesAtATimeAndNeverFallsBelowAThird) {
  std::vector<OdometryFit> fits(1, OdometryFit::Of(Nominal()));
  IncrementSums wild, still;
  for (int i = 0; i < 1000; ++i) {
    wild.AddIncrement({1.0, 0.0, 1.0, 1.0}, {0.01, 1.0, 0.0}, Nominal());
    still.AddIncrement({1.0, 0.0, 1.0, 1.0}, {0.01, 0.0, 0.0}, Nominal());
  }
  FitWidths({wild}, Nominal(), &fits);
  EXPECT_NEAR(fits[0].turn_ratio, 0.1, 1e-12);
  for (int i = 0; i < 5; ++i) FitWidths({still}, Nominal(), &fits);
  EXPECT_NEAR(fits[0].turn_ratio, 0.05 / 3.0, 1e-12);
}

// Errors of known widths, each seen through noise of the size that the model starts from: iterated, the fit
// finds both widths from a start three times too small and three times too large.
TEST(FitWidths, FindsBothWidthsFromAStartThreeTimesWrong) {
  const double walk = 0.03, turn = 0.06;
  for (const double wrong : {1.0 / 3.0, 3.0}) {
    MotionNoise nominal;
    nominal.heading_walk_rad_per_sqrt_m = wrong * walk;
    nominal.turn_ratio = wrong * turn;
    std::vector<OdometryFit> fits(1, OdometryFit::Of(nominal));
    for (int iteration = 0; iteration < 20; ++iteration) {
      IncrementSums sums;
      Rng rng(7);
      const MotionNoise widths = fits[0].Widths(nominal);
      for (int i = 0; i < 2000; ++i) {
        const MotionIncrement increment{1.0, 0.0, 1.0, i % 2 == 0 ? 0.0 : 1.0};
        const double true_variance = 0.5 * (walk * walk + turn * turn * increment.turn_rad);
        const double seen_variance = 0.0005;
        const double seen = std::sqrt(true_variance) * rng.Normal() + std::sqrt(seen_variance) * rng.Normal();
        const double sigma = ErrorOf(increment, widths).heading_rad, prior = 0.5 * sigma * sigma;
        const double gain = prior / (prior + seen_variance);
        sums.AddIncrement(increment, {prior, gain * seen, (1.0 - gain) * prior}, widths);
      }
      FitWidths({sums}, nominal, &fits);
    }
    EXPECT_NEAR(fits[0].heading_walk_rad_per_sqrt_m, walk, 0.1 * walk) << wrong;
    EXPECT_NEAR(fits[0].turn_ratio, turn, 0.1 * turn) << wrong;
  }
}

}  // namespace
}  // namespace cairn::landmark_map
