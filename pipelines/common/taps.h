// One-dimensional error distributions as weights on a grid, and shifts by fractions of a cell.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace cairn {

// Weights for offsets -reach .. reach; they sum to 1.
struct Taps {
  std::vector<double> weights{1.0};

  int reach() const { return static_cast<int>(weights.size() / 2); }
  double At(int offset) const { return weights[static_cast<std::size_t>(offset + reach())]; }
};

// A centred Gaussian of standard deviation `sigma` [cells], cut at 3.5 sigma. Below one cell three weights
// that keep the variance, so that many small errors add up as they should.
Taps GaussianTaps(double sigma);

// The triangular distribution of [TBF98] footnote 1 with the same variance: half width sqrt(6) sigma.
Taps TriangularTaps(double sigma);

// A weight on a cell offset.
struct StencilPoint {
  int dx = 0, dy = 0;
  double weight = 0.0;
};

// At most three bilinear shifts: no heap, for one is made per motion increment and heading.
struct Stencil {
  int size = 0;
  std::array<StencilPoint, 12> points;
  const StencilPoint* begin() const { return points.data(); }
  const StencilPoint* end() const { return points.data() + size; }
  void Add(int dx, int dy, double weight);  // joins equal offsets
};

// The stencil of a shift by (x, y) cells, bilinear, smeared along the unit direction (ux, uy) by an error of
// standard deviation `sigma` cells (three points at 0 and +-sqrt(3) sigma, exact up to the fifth moment of a
// Gaussian). Weights sum to 1; the mean shift is exact.
Stencil ShiftStencil(double x, double y, double ux, double uy, double sigma);

}  // namespace cairn
