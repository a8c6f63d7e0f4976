// Distances between positions of two boxes that lie apart, as a short series: what a tree over the plane is
// made of.
#pragma once

#include <array>
#include <vector>

#include "pipelines/landmark_learning/error_sum/register_blocks.h"

namespace cairn::landmark_learning {

// With u and v the coordinates in a box, scaled to [-1, 1] on its sides, a position is described by the
// products T_i(u) T_j(v) of Chebyshev polynomials with i + j <= kDegree; of two boxes of side 1, whose
// centres lie `offset` apart,
//
//   |x - y| = sum_cd C_offset[c][d] T_c(x) T_d(y),
//
// to kFarBound of itself wherever the boxes are not near. Coefficients whose degrees add up to more than the
// offset needs are left out.
inline constexpr int kDegree = 6;
inline constexpr int kTerms = (kDegree + 1) * (kDegree + 2) / 2;  // by i + j, then i
inline constexpr double kFarBound = 1e-5;
inline constexpr int kFarthest = 5;  // offset along a side: children of near parents lie no farther apart

constexpr bool IsNear(int dx, int dy) { return dx * dx + dy * dy <= 5; }

// 1-D: T_i((u + side) / 2) = sum_k A[i][k] T_k(u), side -1 or 1: a parent's polynomials in a child's
// coordinate.
using HalfMatrix = std::array<std::array<double, kDegree + 1>, kDegree + 1>;
HalfMatrix HalfOf(int side);

template <class Real>
class FarField {
 public:
  // Made once in a process.
  static const FarField& Get();

  // What a box that lies (dx, dy) away, not near, is to a box: its moments, [kTerms][width].
  struct Meeting {
    const Real* matrix;
    int kept;  // sum of degrees
    const Real* moments;
  };
  Meeting MeetingAt(int dx, int dy, const Real* moments) const;

  // local += scale * (sum of C moments over all that a box meets); [kTerms][width].
  static void Meet(const std::vector<Meeting>& meetings, Real scale, int width, Real* local);

  // A parent's terms in those of its child at (x, y) of its level: [parent's][child's].
  SmallMatrix<Real> ChildOf(int x, int y) const {
    return {kTerms, kTerms, kTerms, children_[static_cast<std::size_t>((x & 1) + 2 * (y & 1))].data()};
  }

 private:
  using Matrix = std::array<Real, kTerms * kTerms>;
  FarField();

  std::vector<Matrix> transfers_;  // [dy + kFarthest][dx + kFarthest]
  std::array<Matrix, 4> children_;
};

// T_c at positions of a box: `terms` [kTerms][stride], `u` and `v` [count].
template <class Real>
void FillTerms(int count, const Real* u, const Real* v, int stride, Real* terms);

}  // namespace cairn::landmark_learning
