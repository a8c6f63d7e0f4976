// Small products of matrices whose sums stay in registers: a matrix of e or the like, [rows][stride], with
// tables of features, [rows or columns][width], width a multiple of a register.
#pragma once

#include <algorithm>
#include <cstddef>

#include "pipelines/landmark_learning/error_sum/lanes.h"

namespace cairn::landmark_learning {

template <class Real>
struct SmallMatrix {
  int rows, columns, stride;
  const Real* cells;

  const Real* Row(int row) const { return cells + static_cast<std::ptrdiff_t>(row) * stride; }
};

// out[row] += sum_column matrix[row][column] in[column] for kRows rows from `row` on and kRegisters registers
// of features. Terms are added from zero on, then to `out`.
template <class Real, int kRows, int kRegisters>
void ProductBlock(const SmallMatrix<Real>& m, int row, int width, const Real* in, Real* out) {
  using L = Lanes<Real>;
  typename L::Register sum[kRows][kRegisters];
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) sum[r][l] = L::Broadcast(Real(0));
  }
  const Real* cells = m.Row(row);
  for (int k = 0; k < m.columns; ++k, in += width) {
    typename L::Register features[kRegisters];
    for (int l = 0; l < kRegisters; ++l) features[l] = L::Load(in + l * L::kCount);
    for (int r = 0; r < kRows; ++r) {
      const auto cell = L::Broadcast(cells[r * m.stride + k]);
      for (int l = 0; l < kRegisters; ++l) sum[r][l] = L::Fma(cell, features[l], sum[r][l]);
    }
  }
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) {
      Real* to = out + (row + r) * width + l * L::kCount;
      L::Store(to, L::Add(L::Load(to), sum[r][l]));
    }
  }
}

// out[column] += sum_row matrix[row][column] in[row] for kColumns columns from `column` on.
template <class Real, int kColumns, int kRegisters>
void TransposedBlock(const SmallMatrix<Real>& m, int column, int width, const Real* in, Real* out) {
  using L = Lanes<Real>;
  out += static_cast<std::ptrdiff_t>(column) * width;
  typename L::Register sum[kColumns][kRegisters];
  for (int i = 0; i < kColumns; ++i) {
    for (int l = 0; l < kRegisters; ++l) sum[i][l] = L::Load(out + i * width + l * L::kCount);
  }
  const Real* cells = m.cells + column;
  for (int row = 0; row < m.rows; ++row, cells += m.stride, in += width) {
    typename L::Register features[kRegisters];
    for (int l = 0; l < kRegisters; ++l) features[l] = L::Load(in + l * L::kCount);
    for (int i = 0; i < kColumns; ++i) {
      const auto cell = L::Broadcast(cells[i]);
      for (int l = 0; l < kRegisters; ++l) sum[i][l] = L::Fma(cell, features[l], sum[i][l]);
    }
  }
  for (int i = 0; i < kColumns; ++i) {
    for (int l = 0; l < kRegisters; ++l) L::Store(out + i * width + l * L::kCount, sum[i][l]);
  }
}

// Covers `rows` by blocks of kMost rows, what is left by pairs and single ones.
template <int kMost, class F>
void InBlocks(int rows, const F& block) {
  int row = 0;
  for (; row + kMost <= rows; row += kMost) block.template operator()<kMost>(row);
  for (; row + 2 <= rows; row += 2) block.template operator()<2>(row);
  for (; row < rows; ++row) block.template operator()<1>(row);
}

// Calls f<registers>(first feature) so that all features are covered, two registers at a time or one.
template <class Real, class F>
void OverFeatures(int width, const F& f) {
  constexpr int kCount = Lanes<Real>::kCount;
  if (width % (2 * kCount) == 0) {
    for (int at = 0; at < width; at += 2 * kCount) f.template operator()<2>(at);
  } else {
    for (int at = 0; at < width; at += kCount) f.template operator()<1>(at);
  }
}

// Twelve of the 16 registers hold sums.
template <class Real>
void AddProduct(const SmallMatrix<Real>& m, int width, const Real* in, Real* out) {
  OverFeatures<Real>(width, [&]<int kRegisters>(int f) {
    InBlocks<12 / kRegisters>(m.rows, [&]<int kRows>(int row) {
      ProductBlock<Real, kRows, kRegisters>(m, row, width, in + f, out + f);
    });
  });
}

template <class Real>
void AddTransposed(const SmallMatrix<Real>& m, int width, const Real* in, Real* out) {
  OverFeatures<Real>(width, [&]<int kRegisters>(int f) {
    InBlocks<12 / kRegisters>(m.columns, [&]<int kColumns>(int column) {
      TransposedBlock<Real, kColumns, kRegisters>(m, column, width, in + f, out + f);
    });
  });
}

}  // namespace cairn::landmark_learning
