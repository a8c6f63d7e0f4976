#include "pipelines/landmark_learning/pair_sums.h"

#include <algorithm>
#include <cstddef>

#include "pipelines/landmark_learning/lanes.h"

namespace cairn::landmark_learning {
namespace {

constexpr int kPieceSamples =
    128;  // summed up before they are added to the rest: less is lost, caches hold them

// A piece of a strip against consecutive samples: [truths][stride] each.
template <class Real>
struct Piece {
  int samples, stride, width;
  const Real *belief, *weighted;
};

// n[a] += sum_k weighted[a][k] G[k], and if kBelief z[a] += sum_k belief[a][k] G[k], for kRows truths and
// kRegisters registers of features.
template <class Real, bool kBelief, int kRows, int kRegisters>
void GatherBlock(const Piece<Real>& p, int a, int f, const Real* g, Real* n, Real* z) {
  using L = Lanes<Real>;
  typename L::Register sum_n[kRows][kRegisters], sum_z[kRows][kRegisters];
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) sum_n[r][l] = sum_z[r][l] = L::Broadcast(Real(0));
  }
  const Real* w = p.weighted + static_cast<std::ptrdiff_t>(a) * p.stride;
  const Real* b = kBelief ? p.belief + static_cast<std::ptrdiff_t>(a) * p.stride : nullptr;
  const Real* row = g + f;
  for (int k = 0; k < p.samples; ++k, row += p.width) {
    typename L::Register features[kRegisters];
    for (int l = 0; l < kRegisters; ++l) features[l] = L::Load(row + l * L::kCount);
    for (int r = 0; r < kRows; ++r) {
      const auto weighted = L::Broadcast(w[r * p.stride + k]);
      for (int l = 0; l < kRegisters; ++l) sum_n[r][l] = L::Fma(weighted, features[l], sum_n[r][l]);
      if constexpr (kBelief) {
        const auto belief = L::Broadcast(b[r * p.stride + k]);
        for (int l = 0; l < kRegisters; ++l) sum_z[r][l] = L::Fma(belief, features[l], sum_z[r][l]);
      }
    }
  }
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) {
      const int at = (a + r) * p.width + f + l * L::kCount;
      L::Store(n + at, L::Add(L::Load(n + at), sum_n[r][l]));
      if constexpr (kBelief) L::Store(z + at, L::Add(L::Load(z + at), sum_z[r][l]));
    }
  }
}

// d[k] += sum_a (weighted[a][k] r[a] + belief[a][k] s[a]) for kRows samples.
template <class Real, bool kBelief, int kRows, int kRegisters>
void ScatterBlock(const Piece<Real>& p, int k, int f, const Real* r, const Real* s, Real* d) {
  using L = Lanes<Real>;
  typename L::Register sum[kRows][kRegisters];
  for (int i = 0; i < kRows; ++i) {
    for (int l = 0; l < kRegisters; ++l) sum[i][l] = L::Load(d + (k + i) * p.width + f + l * L::kCount);
  }
  const Real *w = p.weighted + k, *b = kBelief ? p.belief + k : nullptr;
  for (int a = 0; a < kStripTruths; ++a, w += p.stride) {
    typename L::Register slope_n[kRegisters], slope_z[kRegisters];
    for (int l = 0; l < kRegisters; ++l) {
      slope_n[l] = L::Load(r + a * p.width + f + l * L::kCount);
      if constexpr (kBelief) slope_z[l] = L::Load(s + a * p.width + f + l * L::kCount);
    }
    for (int i = 0; i < kRows; ++i) {
      const auto weighted = L::Broadcast(w[i]);
      for (int l = 0; l < kRegisters; ++l) sum[i][l] = L::Fma(weighted, slope_n[l], sum[i][l]);
      if constexpr (kBelief) {
        const auto belief = L::Broadcast(b[i]);
        for (int l = 0; l < kRegisters; ++l) sum[i][l] = L::Fma(belief, slope_z[l], sum[i][l]);
      }
    }
    if constexpr (kBelief) b += p.stride;
  }
  for (int i = 0; i < kRows; ++i) {
    for (int l = 0; l < kRegisters; ++l) L::Store(d + (k + i) * p.width + f + l * L::kCount, sum[i][l]);
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

// Blocks have as many rows as 16 registers hold sums of: twelve, and eight where two tables are read.
template <bool kBelief, class Real>
void GatherPiece(const Piece<Real>& piece, const Real* g, Real* n, Real* z) {
  OverFeatures<Real>(piece.width, [&]<int kRegisters>(int f) {
    InBlocks<(kBelief ? 6 : 12) / kRegisters>(kStripTruths, [&]<int kRows>(int a) {
      GatherBlock<Real, kBelief, kRows, kRegisters>(piece, a, f, g, n, z);
    });
  });
}

template <bool kBelief, class Real>
void ScatterPiece(const Piece<Real>& piece, const Real* r, const Real* s, Real* d) {
  OverFeatures<Real>(piece.width, [&]<int kRegisters>(int f) {
    InBlocks<(kBelief ? 8 : 12) / kRegisters>(piece.samples, [&]<int kRows>(int k) {
      ScatterBlock<Real, kBelief, kRows, kRegisters>(piece, k, f, r, s, d);
    });
  });
}

// Calls f(first, end) for a stretch, a piece at a time.
template <class F>
void InPieces(const Range& samples, const F& f) {
  for (int first = samples.first; first < samples.end; first += kPieceSamples)
    f(first, std::min(samples.end, first + kPieceSamples));
}

}  // namespace

template <class Real>
void Strip<Real>::Take(const Range& truths) {
  pairs_.Reach(truths, &reached_);
  stretches_.clear();
  stride_ = 0;
  for (const Stretch& stretch : reached_) {
    stretches_.push_back({stretch, stride_});
    stride_ += (stretch.samples.size() + kTileSamples - 1) / kTileSamples * kTileSamples;
  }
  const std::size_t cells = kStripTruths * static_cast<std::size_t>(stride_);
  if (weighted_.size() < cells) {
    belief_.resize(cells);
    weighted_.resize(cells);
  }
  for (const At& at : stretches_)
    pairs_.Fill(truths, at.stretch, stride_, &columns_, &belief_[static_cast<std::size_t>(at.column)],
                &weighted_[static_cast<std::size_t>(at.column)]);
}

template <class Real>
void Strip<Real>::Gather(const FeatureRows<Real>& g, Real* n, Real* z) const {
  const int width = g.width();
  std::fill_n(n, kStripTruths * width, Real(0));
  std::fill_n(z, kStripTruths * width, Real(0));
  for (const At& at : stretches_) {
    const Range& samples = at.stretch.samples;
    if (at.stretch.all) {
      for (int first = samples.first; first < samples.end; first += kTileSamples)
        AddRow(width, g.TileSum(first / kTileSamples), z);
    }
  }
  for (int a = 1; a < kStripTruths; ++a) std::copy_n(z, width, z + a * width);
  for (const At& at : stretches_) {
    InPieces(at.stretch.samples, [&](int first, int end) {
      const int column = at.column + first - at.stretch.samples.first;
      const Piece<Real> piece{end - first, stride_, width, &belief_[static_cast<std::size_t>(column)],
                              &weighted_[static_cast<std::size_t>(column)]};
      if (at.stretch.all)
        GatherPiece<false>(piece, g.Row(first), n, z);
      else
        GatherPiece<true>(piece, g.Row(first), n, z);
    });
  }
}

template <class Real>
void Strip<Real>::Scatter(const Real* r, const Real* s, int width, SlopeRows<Real>* d) const {
  std::vector<Real> sum(s, s + width);  // of s over the strip
  for (int a = 1; a < kStripTruths; ++a) AddRow(width, s + a * width, sum.data());
  for (const At& at : stretches_) {
    const Range& samples = at.stretch.samples;
    if (at.stretch.all) {
      for (int first = samples.first; first < samples.end; first += kTileSamples)
        AddRow(width, sum.data(), d->OfTile(first / kTileSamples));
    }
    InPieces(samples, [&](int first, int end) {
      const int column = at.column + first - samples.first;
      const Piece<Real> piece{end - first, stride_, width, &belief_[static_cast<std::size_t>(column)],
                              &weighted_[static_cast<std::size_t>(column)]};
      if (at.stretch.all)
        ScatterPiece<false>(piece, r, s, d->Row(first));
      else
        ScatterPiece<true>(piece, r, s, d->Row(first));
    });
  }
}

template class Strip<float>;
template class Strip<double>;

}  // namespace cairn::landmark_learning
