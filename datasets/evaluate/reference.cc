#include "datasets/evaluate/reference.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <cstddef>

#include "datasets/common/text_file.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

using Complex = std::complex<double>;

// None: `normal` is singular, for what the other unknowns explain is no unknown.
std::optional<Eigen::VectorXcd> Solve(const Eigen::MatrixXcd& normal, const Eigen::VectorXcd& right) {
  constexpr double kLeastPivot = 1e-9;
  const Eigen::VectorXd scale = normal.diagonal().real().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXcd> factors(scale.asDiagonal() * normal * scale.asDiagonal());
  if (!(factors.vectorD().real().minCoeff() > kLeastPivot)) return std::nullopt;
  return scale.asDiagonal() * factors.solve(scale.asDiagonal() * right);
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
  const auto size = 2 + static_cast<Eigen::Index>(robots.size());
  Eigen::MatrixXcd normal = Eigen::MatrixXcd::Zero(size, size);
  Eigen::VectorXcd right = Eigen::VectorXcd::Zero(size);
  Eigen::Index count = 0;
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
    const std::pair<Eigen::Index, Complex> terms[] = {
        {0, q - mean_theirs}, {1, 1.0}, {2 + static_cast<Eigen::Index>(r), -ray}};
    for (const auto& [i, by] : terms) {
      for (const auto& [j, other] : terms) normal(i, j) += std::conj(by) * other;
      right[i] += std::conj(by) * (p - mean_ours);
    }
  });
  for (Eigen::Index k = 2; k < size; ++k)
    if (robots[static_cast<std::size_t>(k) - 2].empty()) normal(k, k) = 1.0;  // it has no such unknown
  const std::optional<Eigen::VectorXcd> solved = Solve(normal, right);
  if (!solved) return std::nullopt;
  const Eigen::VectorXcd& fit = *solved;
  Reference reference;
  const Complex shift = mean_ours + fit[1] - fit[0] * mean_theirs;
  reference.to_map = {std::abs(fit[0]), std::arg(fit[0]), shift.real(), shift.imag()};
  for (Eigen::Index k = 2; k < size; ++k) reference.point.push_back({fit[k].real(), fit[k].imag()});
  double squares = 0;
  each([&](std::size_t r, Complex p, Complex ray, Complex q) {
    squares += std::norm(fit[0] * q + shift - p - ray * fit[static_cast<Eigen::Index>(r) + 2]);
  });
  reference.rmse_m = std::sqrt(squares / static_cast<double>(count));
  return reference;
}

}  // namespace cairn::datasets
