#include "pipelines/common/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "schema/rng.h"

namespace cairn {
namespace {

constexpr int kHeadings = 12;

LayeredGrid RandomGrid(std::uint64_t seed, const Box& around) {
  Rng rng(seed);
  LayeredGrid grid;
  for (int c = 0; c < kHeadings; ++c) {
    if (rng.Below(4) == 0) {
      grid.layers.emplace_back();
      continue;
    }
    Layer layer(around.Shifted(static_cast<int>(rng.Below(3)), static_cast<int>(rng.Below(3))));
    for (double& value : layer.values) value = rng.Uniform();
    grid.layers.push_back(std::move(layer));
  }
  return grid;
}

double Dot(const LayeredGrid& a, const LayeredGrid& b) {
  double sum = 0;
  for (std::size_t c = 0; c < a.layers.size(); ++c) {
    const Box& box = a.layers[c].box;
    for (int y = box.y0; y < box.y0 + box.ny; ++y) {
      for (int x = box.x0; x < box.x0 + box.nx; ++x) sum += a.layers[c].At(x, y) * b.layers[c].At(x, y);
    }
  }
  return sum;
}

const MotionIncrement kIncrement{2.3, 1.1, 2.6, 0.4};
const IncrementError kError{0.5, 0.4};

TEST(Motion, KeepsMass) {
  const LayeredGrid belief = RandomGrid(1, {0, 0, 5, 4});
  const LayeredGrid moved =
      MotionKernel(kIncrement, kError, 0.5, kHeadings, ErrorShape::kGaussian).Forward(belief);
  EXPECT_NEAR(moved.Sum(), belief.Sum(), 1e-10);
}

// A turn of the frame turns the displacement: layer c moves by R(c * step) d.
TEST(Motion, MovesEachHeadingItsOwnWay) {
  for (const int c : {0, 3, 6, 9}) {  // quarter turns: whole cells
    LayeredGrid belief;
    belief.layers.resize(kHeadings);
    belief.layers[c] = Layer(Box{0, 0, 1, 1});
    belief.layers[c].values[0] = 1.0;
    const LayeredGrid moved =
        MotionKernel({3.0, 1.0, 4.0, 0.0}, {0.0, 0.0}, 1.0, kHeadings, ErrorShape::kGaussian).Forward(belief);
    const double angle = c * 2 * std::numbers::pi / kHeadings;
    const int x = static_cast<int>(std::lround(3 * std::cos(angle) - std::sin(angle)));
    const int y = static_cast<int>(std::lround(3 * std::sin(angle) + std::cos(angle)));
    EXPECT_NEAR(moved.layers[c].At(x, y), 1.0, 1e-9);
  }
}

// <Forward(a), m> = <a, Backward(m)> for any a on the support: [TBF98] eqs 16 and 17.
TEST(Motion, BackwardIsTheTransposeOfForward) {
  for (const ErrorShape shape : {ErrorShape::kGaussian, ErrorShape::kTriangular}) {
    const MotionKernel kernel(kIncrement, kError, 0.5, kHeadings, shape);
    const LayeredGrid alpha = RandomGrid(2, {0, 0, 6, 5});
    const LayeredGrid message = RandomGrid(3, {2, 1, 8, 7});
    EXPECT_NEAR(Dot(kernel.Forward(alpha), message), Dot(alpha, kernel.Backward(message, alpha)), 1e-10);
  }
}

TEST(Motion, SpreadsHeadingsByTheIncrementsError) {
  LayeredGrid belief;
  belief.layers.resize(360);
  belief.layers[0] = Layer(Box{0, 0, 1, 1});
  belief.layers[0].values[0] = 1.0;
  const LayeredGrid moved =
      MotionKernel({10.0, 0.0, 10.0, 0.0}, {0.1, 0.0}, 1.0, 360, ErrorShape::kGaussian).Forward(belief);
  double heading_variance = 0, side_variance = 0, both = 0;
  for (int c = 0; c < 360; ++c) {
    const double h = std::remainder(c * std::numbers::pi / 180, 2 * std::numbers::pi);
    const Layer& layer = moved.layers[c];
    for (int y = layer.box.y0; y < layer.box.y0 + layer.box.ny; ++y) {
      for (int x = layer.box.x0; x < layer.box.x0 + layer.box.nx; ++x) {
        heading_variance += layer.Row(y)[x] * h * h;
        side_variance += layer.Row(y)[x] * y * y;
        both += layer.Row(y)[x] * h * y;
      }
    }
  }
  EXPECT_NEAR(heading_variance, 0.01, 0.0005);
  EXPECT_NEAR(both, 10.0 * 0.01 / 2, 0.005);     // a random walk's: length * variance / 2
  EXPECT_NEAR(side_variance, 100 * 0.005, 0.3);  // half of the error comes before the way
}

// A heading is an angle: however large its error, it varies no more than one that may be any (pi^2 / 3), and
// no heading is ruled out.
TEST(Motion, AnErrorOfManyTurnsLeavesAHeadingThatMayBeAny) {
  for (const ErrorShape shape : {ErrorShape::kGaussian, ErrorShape::kTriangular}) {
    const MotionKernel kernel({0.0, 0.0, 0.0, 0.0}, {20.0, 0.0}, 1.0, 36, shape);
    LayeredGrid belief;
    belief.layers.resize(36);
    belief.layers[5] = Layer(Box{0, 0, 1, 1});
    belief.layers[5].values[0] = 1.0;
    const LayeredGrid turned = kernel.Forward(belief);
    for (int c = 0; c < 36; ++c) EXPECT_GT(turned.layers[c].At(0, 0), 0.01 / 36) << c;
    HalfTurn found;
    kernel.Backward(belief, belief, &found);
    EXPECT_LT(found.prior_rad2, std::numbers::pi * std::numbers::pi / 3);
    EXPECT_LT(std::abs(found.mean_rad), 1e-9);
  }
}

// Every layer's mass moved by `k` headings.
LayeredGrid TurnedBy(const LayeredGrid& grid, int k) {
  LayeredGrid turned;
  turned.layers.resize(kHeadings);
  for (int c = 0; c < kHeadings; ++c) turned.layers[(c + k + kHeadings) % kHeadings] = grid.layers[c];
  return turned;
}

// Of each error of the first half turn, the mass of all paths that have it: turned by hand, shifted by a
// kernel that has no heading error, turned by hand once more.
TEST(Motion, TellsWhatTheFirstHalfTurnWas) {
  const LayeredGrid belief = RandomGrid(4, {0, 0, 4, 3}), message = RandomGrid(5, {3, 1, 6, 6});
  const double step = 2 * std::numbers::pi / kHeadings;
  const double half_variance = 0.5 * kError.heading_rad * kError.heading_rad / (step * step);
  const double taps[] = {half_variance / 2, 1 - half_variance, half_variance / 2};
  const MotionKernel shift(kIncrement, {0.0, kError.along_m}, 0.5, kHeadings, ErrorShape::kGaussian);
  double mass = 0, first = 0, second = 0;
  for (int j = -1; j <= 1; ++j) {
    for (int k = -1; k <= 1; ++k) {
      const LayeredGrid moved = TurnedBy(shift.Forward(TurnedBy(belief, j)), k);
      const double joint = taps[j + 1] * taps[k + 1] * Dot(moved, message);
      mass += joint;
      first += joint * j;
      second += joint * j * j;
    }
  }
  HalfTurn found;
  const MotionKernel kernel(kIncrement, kError, 0.5, kHeadings, ErrorShape::kGaussian);
  const LayeredGrid beta = kernel.Backward(message, belief, &found);
  EXPECT_NEAR(found.prior_rad2, half_variance * step * step, 1e-12);
  EXPECT_NEAR(found.mean_rad, first / mass * step, 1e-12);
  EXPECT_NEAR(found.variance_rad2, (second / mass - std::pow(first / mass, 2)) * step * step, 1e-12);
  EXPECT_GT(std::abs(found.mean_rad), 1e-3);
  EXPECT_NEAR(Dot(belief, beta), Dot(kernel.Forward(belief), message), 1e-10);

  // A message that says nothing leaves the error as it was.
  LayeredGrid flat;
  for (int c = 0; c < kHeadings; ++c) {
    Layer layer(Box{-20, -20, 45, 45});
    layer.values.assign(layer.values.size(), 1.0);
    flat.layers.push_back(std::move(layer));
  }
  kernel.Backward(flat, belief, &found);
  EXPECT_NEAR(found.mean_rad, 0.0, 1e-12);
  EXPECT_NEAR(found.variance_rad2, found.prior_rad2, 1e-12);
}

TEST(ErrorOf, GrowsWithWayAndTurn) {
  const MotionNoise noise{0.002, 0.01, 100.0, 0.02, 0.03};
  const IncrementError error = ErrorOf({4, 0, 4, 0.5}, noise);
  EXPECT_NEAR(error.heading_rad, std::sqrt(4 * (0.01 * 0.01 + 0.002 * 0.002 * 100) + 0.015 * 0.015), 1e-12);
  EXPECT_NEAR(error.along_m, 0.08, 1e-12);
}

}  // namespace
}  // namespace cairn
