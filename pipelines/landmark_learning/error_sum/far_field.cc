#include "pipelines/landmark_learning/error_sum/far_field.h"

#include <cmath>
#include <numbers>

#include "schema/error.h"

namespace cairn::landmark_learning {
namespace {

constexpr int kNodes = 14;  // of the interpolation that coefficients are read from, per axis
constexpr int kSides = 2 * kFarthest + 1;

// Degrees of term c along both axes.
struct Degrees {
  int i, j;
};

const std::array<Degrees, kTerms>& Terms() {
  static const auto kTable = [] {
    std::array<Degrees, kTerms> terms{};
    std::size_t c = 0;
    for (int sum = 0; sum <= kDegree; ++sum)
      for (int i = 0; i <= sum; ++i) terms[c++] = {i, sum - i};
    return terms;
  }();
  return kTable;
}

// The sum of degrees up to which coefficients are kept; below kFarBound by far_field_test.
int KeptDegree(int dx, int dy) {
  const int squares = dx * dx + dy * dy;
  return squares <= 8 ? 10 : squares <= 13 ? 8 : squares <= 17 ? 7 : squares < 32 ? 6 : 5;
}

int DegreeOf(int term) {
  return Terms()[static_cast<std::size_t>(term)].i + Terms()[static_cast<std::size_t>(term)].j;
}

int TermsUpTo(int degree) {
  if (degree < 0) return 0;
  const int d = std::min(degree, kDegree);
  return (d + 1) * (d + 2) / 2;
}

double Angle(int node) { return std::numbers::pi * (node + 0.5) / kNodes; }

// Coefficient i of a polynomial is the sum over its values at the nodes times these.
double Weight(int i, int node) { return (i == 0 ? 1.0 : 2.0) / kNodes * std::cos(i * Angle(node)); }

// values: [nodes][rest] to [kDegree + 1][rest].
std::vector<double> Coefficients(const std::vector<double>& values) {
  const std::size_t rest = values.size() / kNodes;
  std::vector<double> out((kDegree + 1) * rest, 0.0);
  for (int i = 0; i <= kDegree; ++i) {
    for (int node = 0; node < kNodes; ++node) {
      const double weight = Weight(i, node);
      for (std::size_t r = 0; r < rest; ++r)
        out[static_cast<std::size_t>(i) * rest + r] +=
            weight * values[static_cast<std::size_t>(node) * rest + r];
    }
  }
  return out;
}

// [a][rest] to [rest][a].
std::vector<double> Transposed(const std::vector<double>& values, std::size_t rows) {
  const std::size_t rest = values.size() / rows;
  std::vector<double> out(values.size());
  for (std::size_t a = 0; a < rows; ++a)
    for (std::size_t r = 0; r < rest; ++r) out[r * rows + a] = values[a * rest + r];
  return out;
}

// Of distances between boxes, for 0 <= dy <= dx: by degrees (i, j) of the one and (k, l) of the other
// position.
std::vector<double> DistanceCoefficients(int dx, int dy) {
  std::vector<double> values;
  const auto at = [](int node) { return 0.5 * std::cos(Angle(node)); };
  for (int a = 0; a < kNodes; ++a) {
    for (int b = 0; b < kNodes; ++b) {
      for (int c = 0; c < kNodes; ++c) {
        for (int d = 0; d < kNodes; ++d) values.push_back(std::hypot(at(a) - at(c) - dx, at(b) - at(d) - dy));
      }
    }
  }
  for (int axis = 0; axis < 4; ++axis) values = Transposed(Coefficients(values), kDegree + 1);
  return values;
}

// From an offset to another of the same shape: axes swapped, then signs turned.
struct Turn {
  bool swap, x, y;
};

// Of `found` by DistanceCoefficients; T_i is even or odd as i is.
double Turned(const std::vector<double>& found, const Turn& turn, const Degrees& p, const Degrees& q) {
  const auto cell = [&](int i, int j, int k, int l) {
    constexpr int kPer = kDegree + 1;
    return found[static_cast<std::size_t>(((i * kPer + j) * kPer + k) * kPer + l)];
  };
  const double value = turn.swap ? cell(p.j, p.i, q.j, q.i) : cell(p.i, p.j, q.i, q.j);
  const int odd = (turn.x ? p.i + q.i : 0) + (turn.y ? p.j + q.j : 0);
  return odd % 2 == 0 ? value : -value;
}

template <class Matrix, class F>
void FillMatrix(Matrix* matrix, const F& cell) {
  for (int c = 0; c < kTerms; ++c) {
    for (int d = 0; d < kTerms; ++d) {
      (*matrix)[static_cast<std::size_t>(c * kTerms + d)] = static_cast<typename Matrix::value_type>(
          cell(Terms()[static_cast<std::size_t>(c)], Terms()[static_cast<std::size_t>(d)]));
    }
  }
}

}  // namespace

HalfMatrix HalfOf(int side) {
  HalfMatrix half{};
  for (int i = 0; i <= kDegree; ++i) {
    for (int k = 0; k <= i; ++k) {
      double sum = 0.0;
      for (int node = 0; node < kNodes; ++node)
        sum += Weight(k, node) * std::cos(i * std::acos((std::cos(Angle(node)) + side) / 2.0));
      half[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = sum;
    }
  }
  return half;
}

template <class Real>
const FarField<Real>& FarField<Real>::Get() {
  static const FarField kField;
  return kField;
}

template <class Real>
FarField<Real>::FarField() : transfers_(static_cast<std::size_t>(kSides) * kSides), children_{} {
  for (int far = 2; far <= kFarthest; ++far) {
    for (int across = 0; across <= far; ++across) {
      if (IsNear(far, across)) continue;
      const auto found = DistanceCoefficients(far, across);
      for (int bits = 0; bits < 8; ++bits) {
        const Turn turn{(bits & 4) != 0, (bits & 1) != 0, (bits & 2) != 0};
        const int dx = (turn.x ? -1 : 1) * (turn.swap ? across : far);
        const int dy = (turn.y ? -1 : 1) * (turn.swap ? far : across);
        Matrix& matrix = transfers_[static_cast<std::size_t>((dy + kFarthest) * kSides + dx + kFarthest)];
        FillMatrix(&matrix, [&](const Degrees& p, const Degrees& q) {
          return p.i + p.j + q.i + q.j <= KeptDegree(dx, dy) ? Turned(found, turn, p, q) : 0.0;
        });
      }
    }
  }
  for (int child = 0; child < 4; ++child) {
    const HalfMatrix x = HalfOf((child & 1) != 0 ? 1 : -1), y = HalfOf((child & 2) != 0 ? 1 : -1);
    FillMatrix(&children_[static_cast<std::size_t>(child)], [&](const Degrees& p, const Degrees& q) {
      return x[static_cast<std::size_t>(p.i)][static_cast<std::size_t>(q.i)] *
             y[static_cast<std::size_t>(p.j)][static_cast<std::size_t>(q.j)];
    });
  }
}

template <class Real>
auto FarField<Real>::MeetingAt(int dx, int dy, const Real* moments) const -> Meeting {
  CAIRN_DEMAND(!IsNear(dx, dy), "a series for boxes that are too near");
  return {transfers_[static_cast<std::size_t>((dy + kFarthest) * kSides + dx + kFarthest)].data(),
          KeptDegree(dx, dy), moments};
}

namespace {

// kRows terms from `row` on, whose degree is at least `degree`, of all meetings: sums stay in registers.
template <int kRows, int kRegisters, class Real>
void MeetRows(const std::vector<typename FarField<Real>::Meeting>& meetings, int row, int degree, Real scale,
              int width, int f, Real* local) {
  using L = Lanes<Real>;
  typename L::Register sum[kRows][kRegisters];
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) sum[r][l] = L::Broadcast(Real(0));
  }
  for (const auto& meeting : meetings) {
    const int columns = TermsUpTo(meeting.kept - degree);
    const Real *cells = meeting.matrix + row * kTerms, *in = meeting.moments + f;
    for (int d = 0; d < columns; ++d, in += width) {
      typename L::Register moments[kRegisters];
      for (int l = 0; l < kRegisters; ++l) moments[l] = L::Load(in + l * L::kCount);
      for (int r = 0; r < kRows; ++r) {
        const auto cell = L::Broadcast(cells[r * kTerms + d]);
        for (int l = 0; l < kRegisters; ++l) sum[r][l] = L::Fma(cell, moments[l], sum[r][l]);
      }
    }
  }
  const auto by = L::Broadcast(scale);
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) {
      Real* to = local + (row + r) * width + f + l * L::kCount;
      L::Store(to, L::Fma(by, sum[r][l], L::Load(to)));
    }
  }
}

}  // namespace

template <class Real>
void FarField<Real>::Meet(const std::vector<Meeting>& meetings, Real scale, int width, Real* local) {
  constexpr int kRows = 6, kLast = kTerms / kRows * kRows;
  OverFeatures<Real>(width, [&]<int kRegisters>(int f) {
    for (int row = 0; row < kLast; row += kRows)
      MeetRows<kRows, kRegisters, Real>(meetings, row, DegreeOf(row), scale, width, f, local);
    MeetRows<kTerms - kLast, kRegisters, Real>(meetings, kLast, DegreeOf(kLast), scale, width, f, local);
  });
}

template <class Real>
void FillTerms(int count, const Real* u, const Real* v, int stride, Real* terms) {
  for (int k = 0; k < count; ++k) {
    Real tu[kDegree + 1], tv[kDegree + 1];
    tu[0] = tv[0] = Real(1);
    tu[1] = u[k];
    tv[1] = v[k];
    for (int i = 2; i <= kDegree; ++i) {
      tu[i] = std::fma(Real(2) * u[k], tu[i - 1], -tu[i - 2]);
      tv[i] = std::fma(Real(2) * v[k], tv[i - 1], -tv[i - 2]);
    }
    Real* cell = terms + k;
    for (const Degrees term : Terms()) {
      *cell = tu[term.i] * tv[term.j];
      cell += stride;
    }
  }
}

template class FarField<float>;
template class FarField<double>;
template void FillTerms(int, const float*, const float*, int, float*);
template void FillTerms(int, const double*, const double*, int, double*);

}  // namespace cairn::landmark_learning
