// P(xi' | u, xi) of [TBF98] eq. 1 on a grid of x-y-theta, as three simple operators a motion increment.
//
// A belief's layer c stands for headings "odometric heading + c * step": the correction to odometry, not the
// heading itself. So a turn moves nothing (no aliasing of rotations), and a motion increment shifts layer c
// by the odometric displacement rotated by c * step. Errors: half of the motion increment's heading error
// before the shift, half after it (which couples heading and sideways errors as a random walk does), and the
// error of the way along the shift.
#pragma once

#include <vector>

#include "pipelines/common/layered_grid.h"
#include "pipelines/common/taps.h"

namespace cairn {

// Errors of odometry, as standard deviations; see schema/FORMAT.md, noise/.
struct MotionNoise {
  double heading_drift_rad_per_m = 0.0;
  double heading_walk_rad_per_sqrt_m = 0.0;
  double drift_length_m = 0.0;  // over such a distance the unknown drift adds up before landmarks stop it
  double forward_ratio = 0.0;
  double turn_ratio = 0.0;
};

// The displacement between two steps, by odometry.
struct MotionIncrement {
  double dx_m = 0.0, dy_m = 0.0;  // displacement in the odometric frame
  double path_m = 0.0;            // length of the path
  double turn_rad = 0.0;          // sum of the absolute turns
};

// Standard deviations of one motion increment's errors.
struct IncrementError {
  double heading_rad = 0.0;
  double along_m = 0.0;
};
IncrementError ErrorOf(const MotionIncrement& increment, const MotionNoise& noise);

enum class ErrorShape { kGaussian, kTriangular };

// The error of the first of a motion increment's two half turns: what the kernel gives it, and what is left
// of it after the fact.
struct HalfTurn {
  double prior_rad2 = 0.0;                     // variance under the kernel alone
  double mean_rad = 0.0, variance_rad2 = 0.0;  // of the posterior
};

// The kernel of one motion increment on one grid: taps over headings and a stencil per heading, whatever the
// place
// ([TBF98] section 5, symmetry); both half turns have the same taps.
class MotionKernel {
 public:
  MotionKernel(const MotionIncrement& increment, const IncrementError& error, double cell_m, int headings,
               ErrorShape shape);

  // The sum over xi of P(xi' | u, xi) belief(xi): [TBF98] eq. 16. Mass is kept.
  LayeredGrid Forward(const LayeredGrid& belief) const;
  // The sum over xi' of P(xi' | u, xi) message(xi') for xi in `support`'s boxes: [TBF98] eq. 17, the
  // transpose of Forward.
  // `half_turn` (may be nullptr): receives the posterior of the first half turn's error, where `support` is
  // the belief before the motion increment: of the paths that the kernel joins, each weighed by support(xi)
  // P(xi' | u, xi) message(xi').
  LayeredGrid Backward(const LayeredGrid& message, const LayeredGrid& support,
                       HalfTurn* half_turn = nullptr) const;

  // From now on each stencil is kept when it is first made: for a kernel that is used again, by one thread.
  // [TBF98] section 5, caching
  void KeepStencils() { kept_.resize(static_cast<std::size_t>(headings_)); }

  // Multiplications that Forward does a cell; Backward does about as many.
  int TapsACell() const { return 2 * static_cast<int>(half_turn_.weights.size()) + StencilOf(0).size; }

 private:
  LayeredGrid TurnForward(const LayeredGrid& belief) const;
  HalfTurn FirstHalfTurn(const LayeredGrid& belief, const LayeredGrid& middle) const;
  Stencil StencilOf(int layer) const;
  Stencil MakeStencil(int layer) const;
  Taps half_turn_;
  double dx_, dy_, ux_, uy_, along_;  // displacement, its direction, error along it; in cells
  int headings_;
  double heading_step_;                // rad
  mutable std::vector<Stencil> kept_;  // [headings], those of size 0 not made yet; empty: none is kept
};

}  // namespace cairn
