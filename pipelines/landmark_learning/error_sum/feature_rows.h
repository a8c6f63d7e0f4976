// Tables [samples][features] whose rows are whole registers, with what all samples of a tile have in common.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "pipelines/landmark_learning/error_sum/lanes.h"
#include "pipelines/landmark_learning/error_sum/pairs.h"

namespace cairn::landmark_learning {

// 2^n filled up to whole registers.
template <class Real>
int WidthOf(int vectors) {
  constexpr int kCount = Lanes<Real>::kCount;
  return (vectors + kCount - 1) / kCount * kCount;
}

template <class Real>
Real* RowOf(std::vector<Real>& table, int row, int width) {
  return table.data() + static_cast<std::ptrdiff_t>(row) * width;
}
template <class Real>
const Real* RowOf(const std::vector<Real>& table, int row, int width) {
  return table.data() + static_cast<std::ptrdiff_t>(row) * width;
}

// to[f] += from[f]
template <class Real>
void AddRow(int width, const Real* from, Real* to) {
  using L = Lanes<Real>;
  for (int f = 0; f < width; f += L::kCount) L::Store(to + f, L::Add(L::Load(to + f), L::Load(from + f)));
}

// G, and its sums over tiles.
template <class Real>
class FeatureRows {
 public:
  // `probability`: [samples][vectors], must outlive this.
  FeatureRows(const std::vector<Real>& probability, int vectors) : width_(WidthOf<Real>(vectors)) {
    const auto samples = static_cast<int>(probability.size() / static_cast<std::size_t>(vectors));
    rows_ = probability.data();
    if (width_ != vectors) {
      padded_.assign(static_cast<std::size_t>(samples) * static_cast<std::size_t>(width_), Real(0));
      for (int k = 0; k < samples; ++k)
        std::copy_n(RowOf(probability, k, vectors), vectors, RowOf(padded_, k, width_));
      rows_ = padded_.data();
    }
    const int tiles = (samples + kTileSamples - 1) / kTileSamples;
    tile_sums_.assign(static_cast<std::size_t>(tiles) * static_cast<std::size_t>(width_), Real(0));
    for (int k = 0; k < samples; ++k) AddRow(width_, Row(k), RowOf(tile_sums_, k / kTileSamples, width_));
  }

  int width() const { return width_; }
  const Real* Row(int k) const { return rows_ + static_cast<std::ptrdiff_t>(k) * width_; }
  const Real* TileSum(int tile) const { return RowOf(tile_sums_, tile, width_); }

 private:
  int width_;
  const Real* rows_;
  std::vector<Real> padded_, tile_sums_;
};

// dE/dG as it adds up.
template <class Real>
class GradientRows {
 public:
  GradientRows(int samples, int vectors)
      : samples_(samples),
        vectors_(vectors),
        width_(WidthOf<Real>(vectors)),
        rows_(static_cast<std::size_t>(samples) * static_cast<std::size_t>(width_), Real(0)),
        of_tiles_(static_cast<std::size_t>((samples + kTileSamples - 1) / kTileSamples) *
                      static_cast<std::size_t>(width_),
                  Real(0)) {}

  Real* Row(int k) { return RowOf(rows_, k, width_); }
  // What is added to each row of the tile.
  Real* OfTile(int tile) { return RowOf(of_tiles_, tile, width_); }

  // [samples][vectors]; leaves this empty.
  std::vector<Real> Take() {
    for (int k = 0; k < samples_; ++k) AddRow(width_, OfTile(k / kTileSamples), Row(k));
    if (width_ != vectors_) {
      for (int k = 1; k < samples_; ++k) std::copy_n(Row(k), vectors_, RowOf(rows_, k, vectors_));
      rows_.resize(static_cast<std::size_t>(samples_) * static_cast<std::size_t>(vectors_));
    }
    return std::move(rows_);
  }

 private:
  int samples_, vectors_, width_;
  std::vector<Real> rows_, of_tiles_;
};

}  // namespace cairn::landmark_learning
