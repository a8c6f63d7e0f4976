#include "pipelines/landmark_learning/error_sum/posterior_error.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "pipelines/landmark_learning/error_sum/pair_sums.h"

namespace cairn::landmark_learning {
namespace {

// N and Z of a strip; then what the gradients of pairs need: P G / Z and -P G N / Z^2.
template <class Real>
struct StripSums {
  std::vector<Real> n, z;  // [kStripTruePositions][width]

  explicit StripSums(int width) : n(kStripTruePositions * static_cast<std::size_t>(width)), z(n.size()) {}
};

// Adds to E and to its slope in G[a], and turns N and Z into gradients. Terms of one feature are added up by
// themselves, feature after feature only at the end.
template <class Real>
class ErrorGradient {
 public:
  ErrorGradient(const FeatureRows<Real>& g, const std::vector<double>& weight, ErrorKind kind)
      : g_(g),
        kind_(kind),
        weight_(weight),
        error_(static_cast<std::size_t>(g.width()), Real(0)),
        whole_(error_.size(), 0.0) {}

  void Turn(const IndexRange& true_positions, StripSums<Real>* sums, GradientRows<Real>* d) {
    const int width = g_.width();
    std::ranges::fill(error_, Real(0));
    for (int a = true_positions.first; a < true_positions.end; ++a) {
      Real *n = RowOf(sums->n, a - true_positions.first, width),
           *z = RowOf(sums->z, a - true_positions.first, width);
      if (kind_ == ErrorKind::kPosteriorMass)
        TurnRowOfMass(a, n, z, d->Row(a));
      else
        TurnRow(a, n, z, d->Row(a));
    }
    std::fill(sums->n.begin() + true_positions.size() * width, sums->n.end(), Real(0));
    std::fill(sums->z.begin() + true_positions.size() * width, sums->z.end(), Real(0));
    for (std::size_t f = 0; f < whole_.size(); ++f) whole_[f] += error_[f];
  }
  double Error() const {
    double sum = 0.0;
    for (const double of_feature : whole_) sum += of_feature;
    return sum;
  }

 private:
  void TurnRow(int a, Real* n, Real* z, Real* slope) {
    using L = Lanes<Real>;
    const auto zero = L::Broadcast(Real(0));
    const auto p = L::Broadcast(static_cast<Real>(weight_[static_cast<std::size_t>(a)]));
    const Real* g = g_.Row(a);
    for (int f = 0; f < g_.width(); f += L::kCount) {
      const auto here = L::Load(z + f);
      const auto expected = L::IfLess(zero, here, L::Mul(p, L::Div(L::Load(n + f), here)));
      const auto r = L::IfLess(zero, here, L::Div(L::Mul(p, L::Load(g + f)), here));
      Real* error = &error_[static_cast<std::size_t>(f)];
      // [Thr98] eqs 23, 36, 42: P(xi*) G N / Z, summed over f
      L::Store(error, L::Fma(L::Load(g + f), expected, L::Load(error)));
      L::Store(slope + f, L::Add(L::Load(slope + f), expected));
      // [Thr98] eqs 40, 43: dE/dZ = -P G N / Z^2 and dE/dN = P G / Z
      L::Store(z + f, L::IfLess(zero, here, L::Sub(zero, L::Div(L::Mul(L::Load(g + f), expected), here))));
      L::Store(n + f, r);
    }
  }

  // E is the sum of P G cost(N / Z).
  void TurnRowOfMass(int a, Real* n, Real* z, Real* slope) {
    const double p = weight_[static_cast<std::size_t>(a)];
    const Real* g = g_.Row(a);
    for (int f = 0; f < g_.width(); ++f) {
      const double here = z[f], mass = here > 0.0 ? n[f] / here : 0.0;
      const double cost = here > 0.0 ? p * MassCost::Of(mass) : 0.0;
      const double r = here > 0.0 ? p * g[f] * MassCost::Derivative(mass) / here : 0.0;
      error_[static_cast<std::size_t>(f)] += static_cast<Real>(g[f] * cost);
      slope[f] += static_cast<Real>(cost);
      n[f] = static_cast<Real>(r);
      z[f] = static_cast<Real>(-r * mass);
    }
  }

  const FeatureRows<Real>& g_;
  ErrorKind kind_;
  const std::vector<double>& weight_;
  std::vector<Real> error_;  // of a strip, by feature
  std::vector<double> whole_;
};

// Of N / Z, which is the error that is expected, or the mass whose cost is.
double CostOf(const Pairs& pairs, double ratio) {
  return pairs.error() == ErrorKind::kPosteriorMass ? MassCost::Of(ratio) : ratio;
}

// Calls f(strip) for the strips of a block.
template <class F>
void InStrips(const IndexRange& true_positions, const F& f) {
  for (int first = true_positions.first; first < true_positions.end; first += kStripTruePositions)
    f(IndexRange{first, std::min(true_positions.end, first + kStripTruePositions)});
}

}  // namespace

template <class Real>
ErrorShare<Real> ErrorOfTruePositions(const Pairs& pairs, const std::vector<Real>& probability, int vectors,
                                      const std::vector<double>& weight, const IndexRange& true_positions) {
  const FeatureRows<Real> g(probability, vectors);
  GradientRows<Real> d(pairs.samples().size(), vectors);
  ErrorGradient<Real> gradient(g, weight, pairs.error().kind);
  StripSums<Real> sums(g.width());
  Strip<Real> strip(pairs);
  InStrips(true_positions, [&](const IndexRange& range) {
    strip.Take(range);
    strip.Gather(g, sums.n.data(), sums.z.data());
    gradient.Turn(range, &sums, &d);
    strip.Scatter(sums.n.data(), sums.z.data(), g.width(), &d);
  });
  return {gradient.Error(), d.Take()};
}

template <class Real>
double ErrorInMap(const Pairs& pairs, const std::vector<Real>& of_truth, const std::vector<Real>& of_sample,
                  int vectors, const std::vector<double>& weight, const IndexRange& true_positions) {
  double error = 0.0;
  const FeatureRows<Real> map(of_sample, vectors);
  StripSums<Real> sums(map.width());
  Strip<Real> strip(pairs);
  InStrips(true_positions, [&](const IndexRange& range) {
    strip.Take(range);
    strip.Gather(map, sums.n.data(), sums.z.data());
    for (int a = range.first; a < range.end; ++a) {
      const Real *g = RowOf(of_truth, a, vectors), *n = RowOf(sums.n, a - range.first, map.width()),
                 *z = RowOf(sums.z, a - range.first, map.width());
      double ruled_out = 0.0;  // probability of what the map holds for impossible
      for (int f = 0; f < vectors; ++f) {
        if (z[f] > 0)
          // [Thr98] eqs 36, 42, of true positions that are not the samples that they are taken for
          error += weight[static_cast<std::size_t>(a)] * g[f] * CostOf(pairs, n[f] / z[f]);
        else
          ruled_out += g[f];
      }
      if (ruled_out > 0.0) error += ruled_out * PriorErrorOfTruePositions(pairs, weight, {a, a + 1});
    }
  });
  return error;
}

double PriorErrorOfTruePositions(const Pairs& pairs, const std::vector<double>& weight,
                                 const IndexRange& true_positions) {
  constexpr int kPiece = 512;
  std::vector<Stretch> stretches;
  Columns<double> columns;
  std::vector<double> believed, weighted(static_cast<std::size_t>(kStripTruePositions) * kPiece);
  double sum = 0.0;
  InStrips(true_positions, [&](const IndexRange& strip) {
    std::array<double, kStripTruePositions> all{}, wrong{};
    pairs.Reach(strip, &stretches);
    for (const Stretch& stretch : stretches) {
      for (int first = stretch.samples.first; first < stretch.samples.end; first += kPiece) {
        const Stretch piece{{first, std::min(stretch.samples.end, first + kPiece)}, stretch.all};
        believed.assign(weighted.size(), 1.0);
        pairs.Fill(strip, piece, kPiece, &columns, believed.data(), weighted.data());
        for (int k = 0; k < piece.samples.size(); ++k) {
          for (std::size_t a = 0; a < kStripTruePositions; ++a) {
            all[a] += believed[a * kPiece + static_cast<std::size_t>(k)];
            wrong[a] += weighted[a * kPiece + static_cast<std::size_t>(k)];
          }
        }
      }
    }
    for (int a = strip.first; a < strip.end; ++a) {
      const auto own = static_cast<std::size_t>(a - strip.first);
      // [Thr98] eq. 21
      if (all[own] > 0.0) sum += weight[static_cast<std::size_t>(a)] * CostOf(pairs, wrong[own] / all[own]);
    }
  });
  return sum;
}

template ErrorShare<float> ErrorOfTruePositions(const Pairs&, const std::vector<float>&, int,
                                                const std::vector<double>&, const IndexRange&);
template ErrorShare<double> ErrorOfTruePositions(const Pairs&, const std::vector<double>&, int,
                                                 const std::vector<double>&, const IndexRange&);
template double ErrorInMap(const Pairs&, const std::vector<float>&, const std::vector<float>&, int,
                           const std::vector<double>&, const IndexRange&);
template double ErrorInMap(const Pairs&, const std::vector<double>&, const std::vector<double>&, int,
                           const std::vector<double>&, const IndexRange&);

}  // namespace cairn::landmark_learning
