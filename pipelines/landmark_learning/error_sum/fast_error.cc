#include "pipelines/landmark_learning/error_sum/fast_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <optional>

#include "pipelines/landmark_learning/error_sum/feature_rows.h"
#include "pipelines/landmark_learning/error_sum/line_sums.h"
#include "pipelines/landmark_learning/error_sum/tree_sums.h"

namespace cairn::landmark_learning {
namespace {

// to[k][0 … columns) = from[k][0 … columns)
template <class From, class To>
void CopyColumns(int rows, int columns, const From* from, int from_width, To* to, int to_width) {
  for (int k = 0; k < rows; ++k, from += from_width, to += to_width)
    for (int f = 0; f < columns; ++f) to[f] = static_cast<To>(from[f]);
}

template <class Real>
std::vector<Real> SumOfRows(const std::vector<Real>& rows, int width) {
  std::vector<Real> sum(static_cast<std::size_t>(width), Real(0));
  for (std::size_t at = 0; at < rows.size(); at += sum.size()) AddRow(width, &rows[at], sum.data());
  return sum;
}

// Turns N of a row into the slope by it, P G / Z, and gives that by Z, -P G N / Z^2, and dE/dG[a]. Z is not
// zero where G is not: a sample may be taken for itself.
template <class Real>
void TurnRow(double p, int width, const Real* g, const Real* z, Real* n, Real* by_z, Real* d, Real* error) {
  using L = Lanes<Real>;
  const auto weight = L::Broadcast(static_cast<Real>(p)), zero = L::Broadcast(Real(0)),
             one = L::Broadcast(Real(1));
  for (int f = 0; f < width; f += L::kCount) {
    const auto here = L::Load(z + f), wrong = L::Load(n + f);
    const auto inverse = L::IfLess(zero, here, L::Div(one, here));
    const auto share = L::Mul(weight, inverse);
    const auto expected = L::Mul(wrong, share), r = L::Mul(L::Load(g + f), share);
    // [Thr98] eqs 36, 42
    L::Store(error + f, L::Fma(L::Load(g + f), expected, L::Load(error + f)));
    L::Store(d + f, expected);
    L::Store(n + f, r);
    // [Thr98] eqs 40, 43
    L::Store(by_z + f, L::Sub(zero, L::Mul(r, L::Mul(wrong, inverse))));
  }
}

// E and dE/dG of some features, by `multiply(h, weighted, believed)`, which adds the products with e B and
// with B, each unless null. Where the belief is global B is one, and its product a sum over all samples.
template <class Real>
struct ProductTables {
  int width;
  bool global;
  std::vector<Real> g, n, z, d;  // [samples][width]; g is what is given, d what comes out

  ProductTables(int samples, int features, bool is_global)
      : width(features),
        global(is_global),
        g(static_cast<std::size_t>(samples) * static_cast<std::size_t>(features), Real(0)),
        n(g),
        z(global ? 0 : g.size()),
        d(g) {}

  template <class F>
  double Error(const F& multiply, const std::vector<double>& weight, const IndexRange& true_positions) {
    std::ranges::fill(n, Real(0));
    std::ranges::fill(z, Real(0));
    multiply(g.data(), n.data(), global ? nullptr : z.data());
    std::ranges::fill(d, Real(0));
    const double error = Turn(weight, true_positions);
    // e and B are symmetric: gradients go back the way that the features came.
    multiply(n.data(), d.data(), nullptr);
    if (!global) multiply(z.data(), nullptr, d.data());
    return error;
  }

 private:
  // From N and Z, in place, to the gradients by them; those by a Z that all have in common go into d at once.
  double Turn(const std::vector<double>& weight, const IndexRange& true_positions) {
    const auto row_size = static_cast<std::size_t>(width);
    std::vector<Real> error(row_size, Real(0)), all, by_all(row_size, Real(0)), by_z(row_size);
    if (global) all = SumOfRows(g, width);
    const int samples = static_cast<int>(g.size() / row_size);
    for (int a = 0; a < samples; ++a) {
      if (a < true_positions.first || a >= true_positions.end) {
        std::fill_n(RowOf(n, a, width), width, Real(0));
        if (!global) std::fill_n(RowOf(z, a, width), width, Real(0));
        continue;
      }
      TurnRow(weight[static_cast<std::size_t>(a)], width, RowOf(g, a, width),
              global ? all.data() : RowOf(z, a, width), RowOf(n, a, width), by_z.data(), RowOf(d, a, width),
              error.data());
      if (global)
        AddRow(width, by_z.data(), by_all.data());
      else
        std::ranges::copy(by_z, RowOf(z, a, width));
    }
    if (global) {
      for (std::size_t at = 0; at < d.size(); at += row_size) AddRow(width, by_all.data(), &d[at]);
    }
    return std::accumulate(error.begin(), error.end(), 0.0);
  }
};

}  // namespace

template <class Real>
ErrorShare<Real> ErrorOnLine(const Positions& positions, const Belief& belief, ErrorKind error,
                             const std::vector<Real>& probability, int vectors,
                             const std::vector<double>& weight, const IndexRange& true_positions) {
  const bool squared = error == ErrorKind::kSquaredDistance, global = std::isinf(belief.ReachM());
  const LineSums first(error == ErrorKind::kAlong ? positions.along_m : positions.x_m, belief.ReachM(),
                       squared);
  std::optional<LineSums> second;  // the other share of a squared distance, unless it is zero
  const bool level = std::ranges::adjacent_find(positions.y_m, std::not_equal_to<>()) == positions.y_m.end();
  if (squared && global && !level) second.emplace(positions.y_m, belief.ReachM(), squared);
  const auto multiply = [&](const double* h, double* weighted, double* believed) {
    first.Add(h, weighted, believed);
    if (second && weighted != nullptr) second->Add(h, weighted, nullptr);
  };
  ErrorShare<Real> share{0.0, std::vector<Real>(probability.size())};
  ProductTables<double> products(positions.size(), kLineFeatures, global);
  for (int f = 0; f < vectors; f += kLineFeatures) {
    const int features = std::min(kLineFeatures, vectors - f);
    CopyColumns(positions.size(), features, &probability[static_cast<std::size_t>(f)], vectors,
                products.g.data(), kLineFeatures);
    share.posterior += products.Error(multiply, weight, true_positions);
    CopyColumns(positions.size(), features, products.d.data(), kLineFeatures,
                &share.d_probability[static_cast<std::size_t>(f)], vectors);
  }
  return share;
}

template <class Real>
ErrorShare<Real> ErrorInPlane(const Positions& positions, const std::vector<Real>& probability, int vectors,
                              const std::vector<double>& weight, const IndexRange& true_positions) {
  TreeSums<Real> tree(positions);
  const int width = WidthOf<Real>(vectors);
  ProductTables<Real> products(positions.size(), width, true);
  CopyColumns(positions.size(), vectors, probability.data(), vectors, products.g.data(), width);
  ErrorShare<Real> share{0.0, std::vector<Real>(probability.size())};
  share.posterior = products.Error(
      [&](const Real* h, Real* weighted, Real*) { tree.Add(h, width, weighted); }, weight, true_positions);
  CopyColumns(positions.size(), vectors, products.d.data(), width, share.d_probability.data(), vectors);
  return share;
}

template ErrorShare<float> ErrorOnLine(const Positions&, const Belief&, ErrorKind, const std::vector<float>&,
                                       int, const std::vector<double>&, const IndexRange&);
template ErrorShare<double> ErrorOnLine(const Positions&, const Belief&, ErrorKind,
                                        const std::vector<double>&, int, const std::vector<double>&,
                                        const IndexRange&);

template ErrorShare<float> ErrorInPlane(const Positions&, const std::vector<float>&, int,
                                        const std::vector<double>&, const IndexRange&);
template ErrorShare<double> ErrorInPlane(const Positions&, const std::vector<double>&, int,
                                         const std::vector<double>&, const IndexRange&);

}  // namespace cairn::landmark_learning
