#include "pipelines/landmark_learning/error_sum/pair_sums.h"

#include <algorithm>
#include <cstddef>

namespace cairn::landmark_learning {
namespace {

constexpr int kPieceSamples =
    128;  // summed up before they are added to the rest: less is lost, caches hold them

// Calls f(first, end) for a stretch, a piece at a time.
template <class F>
void InPieces(const IndexRange& samples, const F& f) {
  for (int first = samples.first; first < samples.end; first += kPieceSamples)
    f(first, std::min(samples.end, first + kPieceSamples));
}

}  // namespace

template <class Real>
void Strip<Real>::Take(const IndexRange& true_positions) {
  pairs_.Reach(true_positions, &reached_);
  stretches_.clear();
  stride_ = 0;
  for (const Stretch& stretch : reached_) {
    stretches_.push_back({stretch, stride_});
    stride_ += (stretch.samples.size() + kTileSamples - 1) / kTileSamples * kTileSamples;
  }
  const std::size_t cells = kStripTruePositions * static_cast<std::size_t>(stride_);
  if (weighted_.size() < cells) {
    belief_.resize(cells);
    weighted_.resize(cells);
  }
  for (const At& at : stretches_)
    pairs_.Fill(true_positions, at.stretch, stride_, &columns_, &belief_[static_cast<std::size_t>(at.column)],
                &weighted_[static_cast<std::size_t>(at.column)]);
}

template <class Real>
void Strip<Real>::Gather(const FeatureRows<Real>& g, Real* n, Real* z) const {
  const int width = g.width();
  std::fill_n(n, kStripTruePositions * width, Real(0));
  std::fill_n(z, kStripTruePositions * width, Real(0));
  for (const At& at : stretches_) {
    const IndexRange& samples = at.stretch.samples;
    if (at.stretch.all) {
      for (int first = samples.first; first < samples.end; first += kTileSamples)
        AddRow(width, g.TileSum(first / kTileSamples), z);
    }
  }
  for (int a = 1; a < kStripTruePositions; ++a) std::copy_n(z, width, z + a * width);
  for (const At& at : stretches_) {
    InPieces(at.stretch.samples, [&](int first, int end) {
      // [Thr98] eqs 36, 37: N = (e Bel_prior) G, and Z = P(f) = Bel_prior G
      AddProduct(Part(weighted_, at, first, end), width, g.Row(first), n);
      if (!at.stretch.all) AddProduct(Part(belief_, at, first, end), width, g.Row(first), z);
    });
  }
}

template <class Real>
void Strip<Real>::Scatter(const Real* r, const Real* s, int width, GradientRows<Real>* d) const {
  std::vector<Real> sum(s, s + width);  // of s over the strip
  for (int a = 1; a < kStripTruePositions; ++a) AddRow(width, s + a * width, sum.data());
  for (const At& at : stretches_) {
    const IndexRange& samples = at.stretch.samples;
    if (at.stretch.all) {
      for (int first = samples.first; first < samples.end; first += kTileSamples)
        AddRow(width, sum.data(), d->OfTile(first / kTileSamples));
    }
    InPieces(samples, [&](int first, int end) {
      // [Thr98] eqs 40, 43: the gradients by N and Z go back to the samples of both.
      AddTransposed(Part(weighted_, at, first, end), width, r, d->Row(first));
      if (!at.stretch.all) AddTransposed(Part(belief_, at, first, end), width, s, d->Row(first));
    });
  }
}

template <class Real>
SmallMatrix<Real> Strip<Real>::Part(const std::vector<Real>& table, const At& at, int first, int end) const {
  const int column = at.column + first - at.stretch.samples.first;
  return {kStripTruePositions, end - first, stride_, &table[static_cast<std::size_t>(column)]};
}

template class Strip<float>;
template class Strip<double>;

}  // namespace cairn::landmark_learning
