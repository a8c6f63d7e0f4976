#include "datasets/evaluate/matching/similarity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "schema/rng.h"

namespace cairn::datasets {
namespace {

std::vector<PointPair> NoisyPairs(std::uint64_t seed, std::size_t count, double noise_m) {
  Rng rng(seed);
  const Similarity motion{1.3, 2.1, -4, 7};
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const Point from{rng.Uniform(-50, 50), rng.Uniform(-50, 50)};
    const Point to = motion(from);
    pairs.push_back({from, {to.x_m + noise_m * rng.Normal(), to.y_m + noise_m * rng.Normal()}});
  }
  return pairs;
}

TEST(Similarity, TurnsScalesAndShiftsByHand) {
  const Similarity motion{2, std::numbers::pi / 2, 10, 20};
  const Point at = motion(Point{1, 0});
  EXPECT_NEAR(at.x_m, 10, 1e-12);
  EXPECT_NEAR(at.y_m, 22, 1e-12);
  const Pose pose = motion(Pose{1, 0, std::numbers::pi});
  EXPECT_NEAR(pose.heading_rad, -std::numbers::pi / 2, 1e-12);
}

TEST(Similarity, FitFindsTheTransformOfExactPairs) {
  const Similarity fit = FitSimilarity(NoisyPairs(1, 10, 0));
  EXPECT_NEAR(fit.scale, 1.3, 1e-12);
  EXPECT_NEAR(fit.angle_rad, 2.1, 1e-12);
  EXPECT_NEAR(fit.x_m, -4, 1e-11);
  EXPECT_NEAR(fit.y_m, 7, 1e-11);
}

// Eigen's umeyama goes by the singular value decomposition.
TEST(Similarity, FitAgreesWithEigensUmeyama) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto pairs = NoisyPairs(seed, 12, 3);
    Eigen::MatrixXd from(2, pairs.size()), to(2, pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      from.col(static_cast<Eigen::Index>(i)) << pairs[i].from.x_m, pairs[i].from.y_m;
      to.col(static_cast<Eigen::Index>(i)) << pairs[i].to.x_m, pairs[i].to.y_m;
    }
    for (const bool with_scale : {false, true}) {
      const Eigen::MatrixXd expected = Eigen::umeyama(from, to, with_scale);
      const Similarity fit = with_scale ? FitSimilarity(pairs) : FitRigid(pairs);
      EXPECT_NEAR(fit.scale * std::cos(fit.angle_rad), expected(0, 0), 1e-12);
      EXPECT_NEAR(fit.scale * std::sin(fit.angle_rad), expected(1, 0), 1e-12);
      EXPECT_NEAR(fit.x_m, expected(0, 2), 1e-11);
      EXPECT_NEAR(fit.y_m, expected(1, 2), 1e-11);
    }
  }
}

TEST(Similarity, NoNearbyTransformFitsBetter) {
  const auto pairs = NoisyPairs(4, 12, 2);
  const Similarity rigid = FitRigid(pairs), scaled = FitSimilarity(pairs);
  for (const double step : {-1e-3, 1e-3}) {
    EXPECT_LE(RmseM(pairs, rigid), RmseM(pairs, {1, rigid.angle_rad + step, rigid.x_m, rigid.y_m}));
    EXPECT_LE(RmseM(pairs, rigid), RmseM(pairs, {1, rigid.angle_rad, rigid.x_m + step, rigid.y_m}));
    EXPECT_LE(RmseM(pairs, rigid), RmseM(pairs, {1, rigid.angle_rad, rigid.x_m, rigid.y_m + step}));
    EXPECT_LE(RmseM(pairs, scaled),
              RmseM(pairs, {scaled.scale + step, scaled.angle_rad, scaled.x_m, scaled.y_m}));
  }
  EXPECT_LE(RmseM(pairs, scaled), RmseM(pairs, rigid));
}

TEST(Similarity, AMirroredShapeIsNotReflected) {
  const std::vector<PointPair> mirrored = {{{0, 0}, {0, 0}}, {{2, 0}, {-2, 0}}, {{0, 1}, {0, 1}}};
  EXPECT_GT(RmseM(mirrored, FitRigid(mirrored)), 0.3);
}

TEST(Similarity, FewPointsFixWhatTheyCan) {
  EXPECT_EQ(FitRigid({}).angle_rad, 0);
  EXPECT_EQ(FitRigid({}).x_m, 0);
  const Similarity shift = FitSimilarity({{{1, 2}, {4, 7}}});
  EXPECT_EQ(shift.angle_rad, 0);
  EXPECT_EQ(shift.scale, 1);
  EXPECT_EQ(shift.x_m, 3);
  EXPECT_EQ(shift.y_m, 5);
  EXPECT_TRUE(std::isnan(RmseM({}, {})));
}

TEST(Similarity, TheInverseLeadsBack) {
  const Similarity there{2.5, 0.7, 3, -4};
  const Point back = Inverse(there)(there(Point{-1, 6}));
  EXPECT_NEAR(back.x_m, -1, 1e-12);
  EXPECT_NEAR(back.y_m, 6, 1e-12);
}

}  // namespace
}  // namespace cairn::datasets
