// Sums over pairs of samples along a line without the pairs: O(samples) after a sort.
#pragma once

#include <vector>

#include "pipelines/landmark_learning/error_sum/lanes.h"

namespace cairn::landmark_learning {

// Features at a time: a register of them. Tables of more would be fresh memory at every call, which costs
// more than the sums.
inline constexpr int kLineFeatures = Lanes<double>::kCount;

// Products with e and Bel_prior where e is the distance along the line, or its square, and the belief uniform
// within a reach, or everywhere. What lies on one side of a sample is a sum of terms that are not negative,
//
//   F0[a] = sum_k h[k],   F1[a] = sum_k (t[a] - t[k]) h[k]  over k before a:
//   F0[a + 1] = F0[a] + h[a],   F1[a + 1] = F1[a] + (t[a + 1] - t[a]) F0[a + 1]
//
// (squared: F2 too), so nothing cancels, and a product is exact to (4 m + 8) 2^-53 of itself, m the most
// samples in a window. A window that slides would have to subtract what leaves it; instead its part before
// some anchor is taken from sums that were added up backwards from there, each sample in two of them at most.
class LineSums {
 public:
  // `t`: [samples], where each lies on the line, in any order.
  LineSums(const std::vector<double>& t, double reach, bool squared);

  // weighted[a] += sum_k e[a,k] B[a,k] h[k] and believed[a] += sum_k B[a,k] h[k], each unless null; tables
  // [samples][kLineFeatures].
  void Add(const double* h, double* weighted, double* believed) const;

  // How far a product is from exact, relative.
  double Bound() const;

 private:
  // Samples in the order in which a sweep meets them, and where, growing: from the left, from the right.
  struct Order {
    std::vector<int> row;
    std::vector<double> where;
  };
  template <bool kSquared>
  void Sweep(const Order& order, const double* h, double* weighted, double* believed) const;

  Order left_, right_;
  double reach_;
  bool squared_;
};

}  // namespace cairn::landmark_learning
