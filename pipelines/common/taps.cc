#include "pipelines/common/taps.h"

#include <cmath>

namespace cairn {
namespace {

void Normalise(std::vector<double>* weights) {
  double sum = 0.0;
  for (const double w : *weights) sum += w;
  for (double& w : *weights) w /= sum;
}

Taps NarrowTaps(double sigma) {
  const double side = 0.5 * sigma * sigma;
  return {{side, 1.0 - 2.0 * side, side}};
}

void AddBilinear(double x, double y, double weight, Stencil* stencil) {
  const double fx = std::floor(x), fy = std::floor(y);
  const double ax = x - fx, ay = y - fy;
  const int dx = static_cast<int>(fx), dy = static_cast<int>(fy);
  stencil->Add(dx, dy, weight * (1 - ax) * (1 - ay));
  stencil->Add(dx + 1, dy, weight * ax * (1 - ay));
  stencil->Add(dx, dy + 1, weight * (1 - ax) * ay);
  stencil->Add(dx + 1, dy + 1, weight * ax * ay);
}

}  // namespace

Taps GaussianTaps(double sigma) {
  if (sigma <= 0.0) return {};
  if (sigma < 0.7) return NarrowTaps(sigma);
  const int reach = static_cast<int>(std::ceil(3.5 * sigma));
  Taps taps{std::vector<double>(static_cast<std::size_t>(2 * reach + 1))};
  for (int k = -reach; k <= reach; ++k) {
    taps.weights[static_cast<std::size_t>(k + reach)] = std::exp(-0.5 * k * k / (sigma * sigma));
  }
  Normalise(&taps.weights);
  return taps;
}

Taps TriangularTaps(double sigma) {
  if (sigma <= 0.0) return {};
  if (sigma < 0.7) return NarrowTaps(sigma);
  const double half_width = std::sqrt(6.0) * sigma;
  const int reach = static_cast<int>(std::floor(half_width));
  Taps taps{std::vector<double>(static_cast<std::size_t>(2 * reach + 1))};
  for (int k = -reach; k <= reach; ++k) {
    // [TBF98] footnote 1, but for its factor, which Normalise gives
    taps.weights[static_cast<std::size_t>(k + reach)] = 1.0 - std::abs(k) / half_width;
  }
  Normalise(&taps.weights);
  return taps;
}

void Stencil::Add(int dx, int dy, double weight) {
  constexpr double kNothing = 1e-9;
  if (weight < kNothing) return;
  for (int i = 0; i < size; ++i) {
    if (points[i].dx == dx && points[i].dy == dy) {
      points[i].weight += weight;
      return;
    }
  }
  points[size++] = {dx, dy, weight};
}

Stencil ShiftStencil(double x, double y, double ux, double uy, double sigma) {
  Stencil stencil;
  constexpr double kNegligible = 0.05;  // cells: bilinear interpolation smears more
  if (sigma < kNegligible) {
    AddBilinear(x, y, 1.0, &stencil);
  } else {
    const double reach = std::sqrt(3.0) * sigma;
    AddBilinear(x - reach * ux, y - reach * uy, 1.0 / 6.0, &stencil);
    AddBilinear(x, y, 2.0 / 3.0, &stencil);
    AddBilinear(x + reach * ux, y + reach * uy, 1.0 / 6.0, &stencil);
  }
  double sum = 0.0;
  for (const StencilPoint& p : stencil) sum += p.weight;
  for (int i = 0; i < stencil.size; ++i) stencil.points[i].weight /= sum;
  return stencil;
}

}  // namespace cairn
