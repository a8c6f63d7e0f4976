#include "pipelines/common/taps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn {
namespace {

struct Moments {
  double mass = 0, mean = 0, variance = 0;
};

Moments Of(const Taps& taps) {
  Moments m;
  for (int k = -taps.reach(); k <= taps.reach(); ++k) {
    m.mass += taps.At(k);
    m.mean += taps.At(k) * k;
    m.variance += taps.At(k) * k * k;
  }
  return m;
}

TEST(Taps, KeepMassMeanAndVarianceAtAnyWidth) {
  for (const double sigma : {0.01, 0.2, 0.5, 0.69, 1.0, 3.0, 8.0}) {
    const Moments gaussian = Of(GaussianTaps(sigma));
    EXPECT_NEAR(gaussian.mass, 1.0, 1e-12);
    EXPECT_NEAR(gaussian.mean, 0.0, 1e-12);
    EXPECT_NEAR(gaussian.variance, sigma * sigma, 0.02 * sigma * sigma) << sigma;
    const Moments triangular = Of(TriangularTaps(sigma));
    EXPECT_NEAR(triangular.mass, 1.0, 1e-12);
    EXPECT_NEAR(triangular.variance, sigma * sigma, 0.25 * sigma * sigma) << sigma;
  }
  EXPECT_EQ(GaussianTaps(0.0).reach(), 0);
}

// Footnote 1 of [TBF98]: f(x) = max(0, 1/w - |x|/w^2), here at sigma with w = sqrt(6) sigma = 4.
TEST(Taps, TriangularHasThePapersShape) {
  const Taps taps = TriangularTaps(4.0 / std::sqrt(6.0));
  ASSERT_EQ(taps.reach(), 4);
  for (int k = -4; k <= 4; ++k) EXPECT_NEAR(taps.At(k), 1.0 / 4.0 - std::abs(k) / 16.0, 1e-12);
}

TEST(ShiftStencil, MovesTheMeanExactlyAndSpreadsAlongTheWay) {
  const double ux = 0.6, uy = 0.8, sigma = 1.7;
  const Stencil stencil = ShiftStencil(3.25, -1.5, ux, uy, sigma);
  double mass = 0, x = 0, y = 0;
  for (const StencilPoint& p : stencil) {
    mass += p.weight;
    x += p.weight * p.dx;
    y += p.weight * p.dy;
  }
  EXPECT_NEAR(mass, 1.0, 1e-12);
  EXPECT_NEAR(x, 3.25, 1e-12);
  EXPECT_NEAR(y, -1.5, 1e-12);
  double along = 0, across = 0;
  for (const StencilPoint& p : stencil) {
    const double a = (p.dx - x) * ux + (p.dy - y) * uy, c = -(p.dx - x) * uy + (p.dy - y) * ux;
    along += p.weight * a * a;
    across += p.weight * c * c;
  }
  EXPECT_NEAR(along, sigma * sigma,
              0.3);  // bilinear interpolation adds up to a quarter of a cell squared an axis
  EXPECT_LT(across, 0.3);
}

TEST(ShiftStencil, IsOnePointForAWholeNumberOfCells) {
  const Stencil stencil = ShiftStencil(2.0, -3.0, 1.0, 0.0, 0.0);
  ASSERT_EQ(stencil.size, 1);
  EXPECT_EQ(stencil.points[0].dx, 2);
  EXPECT_EQ(stencil.points[0].dy, -3);
}

}  // namespace
}  // namespace cairn
