#include "datasets/evaluate/reference.h"

#include <cmath>
#include <complex>
#include <cstddef>

#include "datasets/common/text_file.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

using Complex = std::complex<double>;

// Solves A x = b in place, A Hermitian and positive, by Cholesky's A = L D L'. False: A is singular.
bool SolveHermitian(std::vector<std::vector<Complex>>* matrix, std::vector<Complex>* x) {
  constexpr double kLeastPivot = 1e-9;  // of the diagonal: what the other unknowns explain is no unknown
  auto& a = *matrix;
  const std::size_t n = a.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double whole = a[i][i].real();
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[k][k] * std::conj(a[j][k]);
      a[i][j] /= a[j][j];
      a[i][i] -= std::norm(a[i][j]) * a[j][j].real();
      (*x)[i] -= a[i][j] * (*x)[j];
    }
    if (!(a[i][i].real() > kLeastPivot * whole)) return false;
  }
  for (std::size_t i = n; i-- > 0;) {
    (*x)[i] /= a[i][i];
    for (std::size_t k = i + 1; k < n; ++k) (*x)[i] -= std::conj(a[k][i]) * (*x)[k];
  }
  return true;
}

}  // namespace

ReferencePoint ReferencePoint::Parse(const std::string& text) {
  if (text == "estimate") return {true, {}};
  const std::size_t comma = text.find(',');
  const char* reason = "";
  const auto x = ParseNumber(text.substr(0, comma), &reason);
  const auto y = comma == std::string::npos ? std::nullopt : ParseNumber(text.substr(comma + 1), &reason);
  if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y))
    throw InputError("--reference-point is 'estimate', or X,Y: metres ahead of the robot and to its left");
  return {false, {*x, *y}};
}

// In the complex plane, with q a true position, p and h the map's position and heading there: s q + t = p +
// exp(i h) l, which is linear in s, t and each robot's l.
std::optional<Reference> FitReference(const std::vector<PosesAndPositions>& robots) {
  const std::size_t size = 2 + robots.size();
  std::vector<std::vector<Complex>> matrix(size, std::vector<Complex>(size));
  std::vector<Complex> fit(size);
  std::size_t count = 0;
  const auto each = [&](const auto& take) {
    for (std::size_t r = 0; r < robots.size(); ++r)
      for (const auto& [ours, theirs] : robots[r])
        take(r, Complex(ours.x_m, ours.y_m), std::polar(1.0, ours.heading_rad),
             Complex(theirs.x_m, theirs.y_m));
  };
  Complex mean_ours, mean_theirs;
  each([&](std::size_t, Complex p, Complex, Complex q) {
    mean_ours += p;
    mean_theirs += q;
    ++count;
  });
  if (count <= size) return std::nullopt;
  mean_ours /= static_cast<double>(count);
  mean_theirs /= static_cast<double>(count);
  each([&](std::size_t r, Complex p, Complex ray, Complex q) {
    const std::pair<std::size_t, Complex> terms[] = {{0, q - mean_theirs}, {1, 1.0}, {2 + r, -ray}};
    for (const auto& [i, by] : terms) {
      for (const auto& [j, other] : terms) matrix[i][j] += std::conj(by) * other;
      fit[i] += std::conj(by) * (p - mean_ours);
    }
  });
  for (std::size_t r = 0; r < robots.size(); ++r)
    if (robots[r].empty()) matrix[2 + r][2 + r] = 1.0;  // it has no such unknown
  if (!SolveHermitian(&matrix, &fit)) return std::nullopt;
  Reference reference;
  const Complex shift = mean_ours + fit[1] - fit[0] * mean_theirs;
  reference.to_map = {std::abs(fit[0]), std::arg(fit[0]), shift.real(), shift.imag()};
  for (std::size_t r = 0; r < robots.size(); ++r)
    reference.point.push_back({fit[2 + r].real(), fit[2 + r].imag()});
  double squares = 0;
  each([&](std::size_t r, Complex p, Complex ray, Complex q) {
    squares += std::norm(fit[0] * q + shift - p - ray * fit[2 + r]);
  });
  reference.rmse_m = std::sqrt(squares / static_cast<double>(count));
  return reference;
}

}  // namespace cairn::datasets
