// Products with the distances between positions in the plane, without all pairs: a tree of boxes, whose far
// ones meet by short series (L. Greengard, V. Rokhlin, A fast algorithm for particle simulations, Journal of
// Computational Physics 73, 1987, with the polynomials of W. Fong, E. Darve, The black-box fast multipole
// method, the same 228, 2009).
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_learning/error_sum/far_field.h"
#include "pipelines/landmark_learning/error_sum/pairs.h"

namespace cairn::landmark_learning {

// Boxes of one size that hold positions, in the order of their children.
struct TreeNode {
  int x, y;        // which of the level's 2^level by 2^level
  IndexRange own;  // children, in the next level; of a leaf: positions, in the tree's order
};

template <class Real>
class TreeSums {
 public:
  explicit TreeSums(const Positions& positions);

  // weighted[a] += sum_k e~[a,k] h[k], tables [positions][width] in the order of `positions`. e~ is symmetric
  // and off from the distance by at most kFarBound of it. Calls use the same memory again.
  void Add(const Real* h, int width, Real* weighted);

  // What Add costs and is counted in: pairs of positions that meet one by one, and pairs of boxes.
  double NearPairs() const;
  double FarPairs() const;

 private:
  // Boxes of one level, and what a call knows of them: [box * kTerms][width].
  struct Level {
    std::vector<TreeNode> nodes;
    std::vector<int> grid;  // [y][x]: node, or -1
    std::vector<Real> moments, local;
  };
  int leaf_level() const { return static_cast<int>(levels_.size()) - 1; }
  const std::vector<TreeNode>& NodesOf(int level) const {
    return levels_[static_cast<std::size_t>(level)].nodes;
  }
  Real* Moments(int level, int node) { return At(&levels_[static_cast<std::size_t>(level)].moments, node); }
  Real* Local(int level, int node) { return At(&levels_[static_cast<std::size_t>(level)].local, node); }
  Real* At(std::vector<Real>* table, int node) const {
    return table->data() + static_cast<std::ptrdiff_t>(node) * kTerms * width_;
  }

  void Sort(const Positions& positions);
  void AddLevel(int level, const std::vector<std::uint64_t>& codes);
  void LinkChildren();
  // Calls f(box, dx, dy) for boxes of the level that lie so far from `node` and have near parents: the near
  // ones, or the others.
  template <class F>
  void ForEach(int level, const TreeNode& node, bool near, const F& f) const;

  void Clear(int width);
  SmallMatrix<Real> TermsIn(const TreeNode& leaf);  // until the next call
  void GatherMoments();
  void MeetFar();
  void SpreadDown();
  void MeetNear();
  std::vector<IndexRange> NearRanges(const TreeNode& leaf) const;

  double low_x_m_ = 0.0, low_y_m_ = 0.0, side_m_ = 1.0;  // of the whole square
  std::vector<int> order_;                               // positions as the tree has them
  Positions sorted_;
  std::vector<Level> levels_;
  int width_ = 0;
  std::vector<Real> h_, sum_;  // by position, in the tree's order
  std::vector<Real> u_, v_, terms_;
};

extern template class TreeSums<float>;
extern template class TreeSums<double>;

}  // namespace cairn::landmark_learning
