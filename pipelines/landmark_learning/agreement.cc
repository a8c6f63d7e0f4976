#include "pipelines/landmark_learning/agreement.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace cairn::landmark_learning {
namespace {

// Its waves along the run but for the mean, [waves][columns]: of each the sum over the rows of the wave times
// how far they are from the first, of which a wave knows nothing.
Eigen::MatrixXd WavesOf(const std::vector<double>& series, std::size_t columns,
                        const std::vector<double>& cosines) {
  const std::size_t rows = series.size() / columns;
  Eigen::MatrixXd waves =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows) - 1, static_cast<Eigen::Index>(columns));
  for (std::size_t wave = 1; wave < rows; ++wave)
    for (std::size_t row = 0; row < rows; ++row) {
      const double cosine = cosines[wave * (2 * row + 1) % cosines.size()];
      for (std::size_t column = 0; column < columns; ++column)
        waves(static_cast<Eigen::Index>(wave) - 1, static_cast<Eigen::Index>(column)) +=
            cosine * (series[row * columns + column] - series[column]);
    }
  return waves;
}

}  // namespace

double AgreementSigmas(const std::vector<double>& one, const std::vector<double>& other,
                       std::size_t columns) {
  const std::size_t rows = one.size() / columns;
  if (rows < 2) return 0.0;
  std::vector<double> cosines;  // of a wave's whole period, in steps of half a row
  for (std::size_t k = 0; k < 4 * rows; ++k)
    cosines.push_back(std::cos(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(rows)));
  const Eigen::MatrixXd of_one = WavesOf(one, columns, cosines), of_other = WavesOf(other, columns, cosines);
  const Eigen::MatrixXd axes =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(of_one.transpose() * of_one).eigenvectors();
  const Eigen::ArrayXXd common = (of_one * axes).array() * (of_other * axes).array();
  const double variance = common.abs().sum();
  return variance > 0.0 ? (common.sign() * common.abs().sqrt()).sum() / std::sqrt(variance) : 0.0;
}

}  // namespace cairn::landmark_learning
