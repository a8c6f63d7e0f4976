#include "pipelines/landmark_learning/posterior_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "pipelines/landmark_learning/lanes.h"

namespace cairn::landmark_learning {
namespace {

constexpr int kTruths = 24;   // of a strip: their sums stay in the nearest cache
constexpr int kSamples = 64;  // of a tile

// A tile of pairs, [truths][samples] each, and how many features a row of G has.
template <class Real>
struct Tile {
  int truths, samples, vectors;
  const Real *belief, *weighted;
};

//   n[a] += sum_k weighted[a][k] G[k],  z[a] += sum_k belief[a][k] G[k]
// for kRows truths and kRegisters registers of features, whose sums stay in registers.
template <class L, class Real, int kRows, int kRegisters>
void GatherBlock(const Tile<Real>& t, int a, int f, const Real* g, Real* n, Real* z) {
  typename L::Register sum_n[kRows][kRegisters], sum_z[kRows][kRegisters];
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) {
      const int at = (a + r) * t.vectors + f + l * L::kCount;
      sum_n[r][l] = L::Load(n + at);
      sum_z[r][l] = L::Load(z + at);
    }
  }
  const Real *w = t.weighted + a * t.samples, *b = t.belief + a * t.samples, *row = g + f;
  for (int k = 0; k < t.samples; ++k, row += t.vectors) {
    typename L::Register features[kRegisters];
    for (int l = 0; l < kRegisters; ++l) features[l] = L::Load(row + l * L::kCount);
    for (int r = 0; r < kRows; ++r) {
      const auto weighted = L::Broadcast(w[r * t.samples + k]), belief = L::Broadcast(b[r * t.samples + k]);
      for (int l = 0; l < kRegisters; ++l) {
        sum_n[r][l] = L::Fma(weighted, features[l], sum_n[r][l]);
        sum_z[r][l] = L::Fma(belief, features[l], sum_z[r][l]);
      }
    }
  }
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) {
      const int at = (a + r) * t.vectors + f + l * L::kCount;
      L::Store(n + at, sum_n[r][l]);
      L::Store(z + at, sum_z[r][l]);
    }
  }
}

// The transpose, for kRows samples: d[k] += sum_a (weighted[a][k] r[a] + belief[a][k] s[a]), `s` already
// negated.
template <class L, class Real, int kRows, int kRegisters>
void ScatterBlock(const Tile<Real>& t, int k, int f, const Real* r, const Real* s, Real* d) {
  typename L::Register sum[kRows][kRegisters];
  for (int i = 0; i < kRows; ++i) {
    for (int l = 0; l < kRegisters; ++l) sum[i][l] = L::Load(d + (k + i) * t.vectors + f + l * L::kCount);
  }
  const Real *w = t.weighted + k, *b = t.belief + k;
  for (int a = 0; a < t.truths; ++a, w += t.samples, b += t.samples) {
    typename L::Register slope_n[kRegisters], slope_z[kRegisters];
    for (int l = 0; l < kRegisters; ++l) {
      slope_n[l] = L::Load(r + a * t.vectors + f + l * L::kCount);
      slope_z[l] = L::Load(s + a * t.vectors + f + l * L::kCount);
    }
    for (int i = 0; i < kRows; ++i) {
      const auto weighted = L::Broadcast(w[i]), belief = L::Broadcast(b[i]);
      for (int l = 0; l < kRegisters; ++l)
        sum[i][l] = L::Fma(belief, slope_z[l], L::Fma(weighted, slope_n[l], sum[i][l]));
    }
  }
  for (int i = 0; i < kRows; ++i) {
    for (int l = 0; l < kRegisters; ++l) L::Store(d + (k + i) * t.vectors + f + l * L::kCount, sum[i][l]);
  }
}

// Covers `rows` by blocks of kMost rows, what is left by single ones.
template <int kMost, class F>
void InBlocks(int rows, const F& block) {
  int row = 0;
  for (; row + kMost <= rows; row += kMost) block.template operator()<kMost>(row);
  for (; row < rows; ++row) block.template operator()<1>(row);
}

// Calls f<L, registers>(first feature) so that all features are covered: two registers at a time, one, or one
// number.
template <class Real, class F>
void OverFeatures(int vectors, const F& f) {
  constexpr int kCount = Lanes<Real>::kCount;
  if (vectors % (2 * kCount) == 0) {
    for (int at = 0; at < vectors; at += 2 * kCount) f.template operator()<Lanes<Real>, 2>(at);
  } else if (vectors % kCount == 0) {
    for (int at = 0; at < vectors; at += kCount) f.template operator()<Lanes<Real>, 1>(at);
  } else {
    for (int at = 0; at < vectors; at += 2) f.template operator()<OneLane<Real>, 2>(at);
  }
}

template <class Real>
void Gather(const Tile<Real>& tile, const Real* g, Real* n, Real* z) {
  OverFeatures<Real>(tile.vectors, [&]<class L, int kRegisters>(int f) {
    InBlocks<3>(tile.truths,
                [&]<int kRows>(int a) { GatherBlock<L, Real, kRows, kRegisters>(tile, a, f, g, n, z); });
  });
}

template <class Real>
void Scatter(const Tile<Real>& tile, const Real* r, const Real* s, Real* d) {
  OverFeatures<Real>(tile.vectors, [&]<class L, int kRegisters>(int f) {
    InBlocks<4>(tile.samples,
                [&]<int kRows>(int k) { ScatterBlock<L, Real, kRows, kRegisters>(tile, k, f, r, s, d); });
  });
}

// The pairs of a strip of truths with all samples in their reach. Its tables are used again for the next
// strip: fresh ones would cost more than what is computed with them.
template <class Real>
class Strip {
 public:
  explicit Strip(const Pairs& pairs) : pairs_(pairs) {}

  void Take(const Range& truths) {
    truths_ = truths;
    tiles_.clear();
    std::size_t cells = 0;
    const int count = pairs_.samples().size();
    for (int first = 0; first < count; first += kSamples) {
      const Range samples{first, std::min(count, first + kSamples)};
      if (!pairs_.Reaches(truths, samples)) continue;
      tiles_.push_back({samples, cells});
      cells += static_cast<std::size_t>(truths.size()) * static_cast<std::size_t>(samples.size());
    }
    if (belief_.size() < cells) {
      belief_.resize(cells);
      weighted_.resize(cells);
    }
    for (const At& tile : tiles_)
      pairs_.Fill(truths, tile.samples, &belief_[tile.cell], &weighted_[tile.cell]);
  }

  // Calls f(first sample, tile) for each tile.
  template <class F>
  void ForEach(int vectors, const F& f) const {
    for (const At& tile : tiles_) {
      f(tile.samples.first,
        Tile<Real>{truths_.size(), tile.samples.size(), vectors, &belief_[tile.cell], &weighted_[tile.cell]});
    }
  }
  const Range& truths() const { return truths_; }

 private:
  struct At {
    Range samples;
    std::size_t cell;  // its first one: [truths][samples] follow
  };
  const Pairs& pairs_;
  Range truths_{0, 0};
  std::vector<At> tiles_;
  std::vector<Real> belief_, weighted_;
};

// N and Z of a strip, [truths][vectors] each.
template <class Real>
struct Sums {
  std::vector<Real> n, z;
};

template <class Real>
auto RowOf(std::vector<Real>& table, int row, int vectors) {
  return table.data() + static_cast<std::ptrdiff_t>(row) * vectors;
}
template <class Real>
auto RowOf(const std::vector<Real>& table, int row, int vectors) {
  return table.data() + static_cast<std::ptrdiff_t>(row) * vectors;
}

template <class Real>
Sums<Real> SumsOf(const Strip<Real>& strip, const std::vector<Real>& probability, int vectors) {
  const auto cells = static_cast<std::size_t>(strip.truths().size()) * static_cast<std::size_t>(vectors);
  Sums<Real> sums{std::vector<Real>(cells, 0), std::vector<Real>(cells, 0)};
  strip.ForEach(vectors, [&](int first, const Tile<Real>& tile) {
    Gather(tile, RowOf(probability, first, vectors), sums.n.data(), sums.z.data());
  });
  return sums;
}

// Adds to E and to its slope in G[a], and turns N and Z into what the slopes of pairs need: P G / Z and
// -P G N / Z^2.
template <class Real>
void TurnIntoSlopes(const Range& truths, const std::vector<Real>& probability, int vectors,
                    const std::vector<double>& weight, Sums<Real>* sums, ErrorShare<Real>* share) {
  std::size_t at = 0;
  for (int a = truths.first; a < truths.end; ++a) {
    const double p = weight[static_cast<std::size_t>(a)];
    const Real* g = RowOf(probability, a, vectors);
    Real* slope = RowOf(share->d_probability, a, vectors);
    for (int f = 0; f < vectors; ++f, ++at) {
      const double z = sums->z[at];
      const double ratio = z > 0.0 ? sums->n[at] / z : 0.0;
      const double r = z > 0.0 ? p * g[f] / z : 0.0;
      share->posterior += p * g[f] * ratio;
      slope[f] += static_cast<Real>(p * ratio);
      sums->n[at] = static_cast<Real>(r);
      sums->z[at] = static_cast<Real>(-r * ratio);
    }
  }
}

// Calls f(strip) for the strips of a block.
template <class F>
void InStrips(const Range& truths, const F& f) {
  for (int first = truths.first; first < truths.end; first += kTruths)
    f(Range{first, std::min(truths.end, first + kTruths)});
}

}  // namespace

template <class Real>
ErrorShare<Real> ErrorOfTruths(const Pairs& pairs, const std::vector<Real>& probability, int vectors,
                               const std::vector<double>& weight, const Range& truths) {
  ErrorShare<Real> share;
  share.d_probability.assign(probability.size(), Real(0));
  Strip<Real> strip(pairs);
  InStrips(truths, [&](const Range& range) {
    strip.Take(range);
    Sums<Real> sums = SumsOf(strip, probability, vectors);
    TurnIntoSlopes(range, probability, vectors, weight, &sums, &share);
    strip.ForEach(vectors, [&](int first, const Tile<Real>& tile) {
      Scatter(tile, sums.n.data(), sums.z.data(), RowOf(share.d_probability, first, vectors));
    });
  });
  return share;
}

template <class Real>
double ErrorInMap(const Pairs& pairs, const std::vector<Real>& of_truth, const std::vector<Real>& of_sample,
                  int vectors, const std::vector<double>& weight, const Range& truths) {
  double error = 0.0;
  Strip<Real> strip(pairs);
  InStrips(truths, [&](const Range& range) {
    strip.Take(range);
    const Sums<Real> sums = SumsOf(strip, of_sample, vectors);
    std::size_t at = 0;
    for (int a = range.first; a < range.end; ++a) {
      const Real* g = RowOf(of_truth, a, vectors);
      double ruled_out = 0.0;  // probability of what the map holds for impossible
      for (int f = 0; f < vectors; ++f, ++at) {
        const double z = sums.z[at];
        if (z > 0.0)
          error += weight[static_cast<std::size_t>(a)] * g[f] * (sums.n[at] / z);
        else
          ruled_out += g[f];
      }
      if (ruled_out > 0.0) error += ruled_out * PriorErrorOfTruths(pairs, weight, {a, a + 1});
    }
  });
  return error;
}

double PriorErrorOfTruths(const Pairs& pairs, const std::vector<double>& weight, const Range& truths) {
  const Range samples{0, pairs.samples().size()};
  std::vector<double> believed(static_cast<std::size_t>(samples.end)), weighted(believed.size());
  double sum = 0.0;
  for (int a = truths.first; a < truths.end; ++a) {
    pairs.Fill({a, a + 1}, samples, believed.data(), weighted.data());
    const double all = std::accumulate(believed.begin(), believed.end(), 0.0);
    if (all > 0.0)
      sum +=
          weight[static_cast<std::size_t>(a)] * std::accumulate(weighted.begin(), weighted.end(), 0.0) / all;
  }
  return sum;
}

template ErrorShare<float> ErrorOfTruths(const Pairs&, const std::vector<float>&, int,
                                         const std::vector<double>&, const Range&);
template ErrorShare<double> ErrorOfTruths(const Pairs&, const std::vector<double>&, int,
                                          const std::vector<double>&, const Range&);
template double ErrorInMap(const Pairs&, const std::vector<float>&, const std::vector<float>&, int,
                           const std::vector<double>&, const Range&);
template double ErrorInMap(const Pairs&, const std::vector<double>&, const std::vector<double>&, int,
                           const std::vector<double>&, const Range&);

}  // namespace cairn::landmark_learning
