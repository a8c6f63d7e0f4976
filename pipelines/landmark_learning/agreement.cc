#include "pipelines/landmark_learning/agreement.h"

#include <cmath>
#include <numbers>

namespace cairn::landmark_learning {
namespace {

// Of wave `wave` of a column: sum over the rows of the wave times how far they are from the first, of which a
// wave knows nothing.
double Coefficient(const std::vector<double>& series, std::size_t columns, std::size_t column,
                   std::size_t wave, const std::vector<double>& cosines) {
  const std::size_t rows = series.size() / columns;
  double sum = 0.0;
  for (std::size_t row = 0; row < rows; ++row)
    sum += (series[row * columns + column] - series[column]) * cosines[wave * (2 * row + 1) % cosines.size()];
  return sum;
}

}  // namespace

double AgreementSigmas(const std::vector<double>& one, const std::vector<double>& other,
                       std::size_t columns) {
  const std::size_t rows = one.size() / columns;
  std::vector<double> cosines;  // of a wave's whole period, in steps of half a row
  for (std::size_t k = 0; k < 4 * rows; ++k)
    cosines.push_back(std::cos(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(rows)));
  double sum = 0.0, variance = 0.0;
  for (std::size_t wave = 1; wave < rows; ++wave) {
    double common = 0.0;
    for (std::size_t column = 0; column < columns; ++column)
      common += Coefficient(one, columns, column, wave, cosines) *
                Coefficient(other, columns, column, wave, cosines);
    sum += std::copysign(std::sqrt(std::abs(common)), common);
    variance += std::abs(common);
  }
  return variance > 0.0 ? sum / std::sqrt(variance) : 0.0;
}

}  // namespace cairn::landmark_learning
