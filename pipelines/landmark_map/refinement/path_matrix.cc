#include "pipelines/landmark_map/refinement/path_matrix.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace cairn::landmark_map {
namespace {

// Of a matrix that is positive definite; false: it is not.
bool InvertPivot(const Eigen::Matrix3d& pivot, Eigen::Matrix3d* lower, Eigen::Matrix3d* inverse) {
  const Eigen::LLT<Eigen::Matrix3d> factor(pivot);
  if (factor.info() != Eigen::Success) return false;
  *lower = factor.matrixL();
  *inverse = factor.solve(Eigen::Matrix3d::Identity());
  return inverse->allFinite();
}

}  // namespace

PathMatrix::PathMatrix(std::span<const int> chain_poses, int shared, std::span<const Coupling> couplings,
                       int segment_poses)
    : shared_(shared) {
  for (const int poses : chain_poses) {
    const int first = static_cast<int>(place_.size());
    for (int k = 0; k < poses; ++k) {
      if (k % (segment_poses + 1) == 0 || k == poses - 1) {  // between two segments
        place_.push_back({-1, rest_size_});
        rest_size_ += 3;
        continue;
      }
      if (place_.back().segment < 0) segments_.emplace_back().first = first + k;
      place_.push_back({static_cast<int>(segments_.size()) - 1, segments_.back().poses++});
    }
  }
  for (const Place& place : place_)
    for (int k = 0; k < 3; ++k) in_rest_.push_back(place.segment < 0 ? place.at + k : -1);
  for (int k = 0; k < shared; ++k) in_rest_.push_back(rest_size_ + k);
  rest_size_ += shared;
  for (Segment& segment : segments_) {
    segment.shared_at.assign(static_cast<std::size_t>(shared), -1);
    for (const int end : {segment.first - 1, segment.first + segment.poses})
      for (int k = 0; k < 3; ++k) segment.border.push_back(place_[static_cast<std::size_t>(end)].at + k);
  }
  for (const Coupling& coupling : couplings) {
    const Place& place = place_[static_cast<std::size_t>(coupling.pose)];
    if (place.segment < 0) continue;
    Segment& segment = segments_[static_cast<std::size_t>(place.segment)];
    int& at = segment.shared_at[static_cast<std::size_t>(coupling.shared)];
    if (at >= 0) continue;
    at = static_cast<int>(segment.border.size());
    segment.border.push_back(rest_size_ - shared + coupling.shared);
  }
  rows_.resize(place_.size());
  for (const Segment& segment : segments_)
    for (int k = 0; k < segment.poses; ++k)
      rows_[static_cast<std::size_t>(segment.first + k)].border.resize(
          3, static_cast<Eigen::Index>(segment.border.size()));
  SetZero();
}

void PathMatrix::SetZero() {
  rest_.clear();
  for (Row& row : rows_) {
    row.own.setZero();
    row.next.setZero();
    row.border.setZero();
  }
}

int PathMatrix::InBorder(const Segment& segment, int in_rest) const {
  if (const int shared = in_rest - (rest_size_ - shared_); shared >= 0)
    return segment.shared_at[static_cast<std::size_t>(shared)];
  return in_rest < segment.border[3] ? in_rest - segment.border[0] : 3 + in_rest - segment.border[3];
}

void PathMatrix::Add(int row, int column, double value) {
  if (row < column) std::swap(row, column);  // now a pose before what is shared, the earlier pose first
  const int row_in_rest = in_rest_[static_cast<std::size_t>(row)],
            column_in_rest = in_rest_[static_cast<std::size_t>(column)];
  if (row_in_rest >= 0 && column_in_rest >= 0) {
    rest_.emplace_back(std::max(row_in_rest, column_in_rest), std::min(row_in_rest, column_in_rest), value);
    return;
  }
  // The one within a segment, and the other.
  const int within = column_in_rest < 0 ? column : row, other = within == column ? row : column;
  Row& at = rows_[static_cast<std::size_t>(within / 3)];
  if (const int in_rest = std::max(row_in_rest, column_in_rest); in_rest >= 0) {
    const Place& place = place_[static_cast<std::size_t>(within / 3)];
    at.border(within % 3, InBorder(segments_[static_cast<std::size_t>(place.segment)], in_rest)) += value;
  } else if (within / 3 == other / 3) {
    at.own(row % 3, column % 3) += value;
    if (row != column) at.own(column % 3, row % 3) += value;
  } else {
    at.next(within % 3, other % 3) += value;
  }
}

Eigen::VectorXd PathMatrix::Diagonal() const {
  Eigen::VectorXd of_rest = Eigen::VectorXd::Zero(rest_size_), diagonal(size());
  for (const auto& entry : rest_)
    if (entry.row() == entry.col()) of_rest[entry.row()] += entry.value();
  for (int k = 0; k < size(); ++k) {
    const int in_rest = in_rest_[static_cast<std::size_t>(k)];
    diagonal[k] = in_rest >= 0 ? of_rest[in_rest] : rows_[static_cast<std::size_t>(k / 3)].own(k % 3, k % 3);
  }
  return diagonal;
}

// With D a pose's pivot, E what couples it with the next pose and R with the border: the next pivot loses
// E' D^-1 E, the next R loses E' D^-1 R, the border's own matrix R' D^-1 R.
bool PathMatrix::Eliminate(const Segment& segment, double damping) {
  const auto width = static_cast<Eigen::Index>(segment.border.size());
  Eigen::MatrixXd border = Eigen::MatrixXd::Zero(width, width);  // its lower triangle
  Eigen::MatrixXd half(width, 3);                                // R' L^-T, with D = L L'
  Eigen::Matrix3d lower, inverse;
  for (int k = 0; k < segment.poses; ++k) {
    Row& row = factor_[static_cast<std::size_t>(segment.first + k)];
    row.own.diagonal() += damping * rows_[static_cast<std::size_t>(segment.first + k)].own.diagonal();
    if (!InvertPivot(row.own, &lower, &inverse)) return false;
    for (Eigen::Index b = 0; b < width; ++b) {
      const double x = row.border(0, b) / lower(0, 0);
      const double y = (row.border(1, b) - lower(1, 0) * x) / lower(1, 1);
      half(b, 0) = x;
      half(b, 1) = y;
      half(b, 2) = (row.border(2, b) - lower(2, 0) * x - lower(2, 1) * y) / lower(2, 2);
    }
    for (Eigen::Index b = 0; b < width; ++b) {
      const Eigen::Index below = width - b;
      border.col(b).tail(below) -= half(b, 0) * half.col(0).tail(below) +
                                   half(b, 1) * half.col(1).tail(below) +
                                   half(b, 2) * half.col(2).tail(below);
    }
    const Eigen::Matrix3d next = row.next;
    row.own = inverse;
    row.next = inverse * next;
    for (Eigen::Index b = 0; b < width; ++b) row.border.col(b) = inverse * Eigen::Vector3d(row.border.col(b));
    if (k + 1 == segment.poses) break;
    Row& after = factor_[static_cast<std::size_t>(segment.first + k + 1)];
    after.own -= next.transpose() * row.next;
    for (Eigen::Index b = 0; b < width; ++b) after.border.col(b) -= next.transpose() * row.border.col(b);
  }
  for (Eigen::Index column = 0; column < width; ++column) {
    for (Eigen::Index row = column; row < width; ++row) {
      const auto [low, high] = std::minmax(segment.border[static_cast<std::size_t>(row)],
                                           segment.border[static_cast<std::size_t>(column)]);
      reduced_.emplace_back(high, low, border(row, column));
    }
  }
  return true;
}

bool PathMatrix::Factorise(double damping) {
  reduced_ = rest_;
  for (const auto& entry : rest_)
    if (entry.row() == entry.col()) reduced_.emplace_back(entry.row(), entry.col(), damping * entry.value());
  factor_ = rows_;
  for (const Segment& segment : segments_)
    if (!Eliminate(segment, damping)) return false;
  Eigen::SparseMatrix<double> rest(rest_size_, rest_size_);
  rest.setFromTriplets(reduced_.begin(), reduced_.end());
  rest_factor_.compute(rest);
  return rest_factor_.info() == Eigen::Success &&
         (rest_size_ == 0 || rest_factor_.vectorD().minCoeff() > 0.0);
}

Eigen::VectorXd PathMatrix::Solve(const Eigen::VectorXd& right_side) const {
  Eigen::VectorXd solution = right_side, rest(rest_size_);
  for (int k = 0; k < size(); ++k)
    if (const int in_rest = in_rest_[static_cast<std::size_t>(k)]; in_rest >= 0)
      rest[in_rest] = right_side[k];
  for (const Segment& segment : segments_) {
    if (right_side.segment(3 * segment.first, 3 * segment.poses).isZero(0.0)) continue;
    for (int k = 0; k < segment.poses; ++k) {
      const int pose = segment.first + k;
      const Row& row = factor_[static_cast<std::size_t>(pose)];
      const Eigen::Vector3d own = solution.segment<3>(3 * pose);
      if (k + 1 < segment.poses) solution.segment<3>(3 * pose + 3) -= row.next.transpose() * own;
      for (std::size_t b = 0; b < segment.border.size(); ++b)
        rest[segment.border[b]] -= row.border.col(static_cast<Eigen::Index>(b)).dot(own);
      solution.segment<3>(3 * pose) = row.own * own;
    }
  }
  rest = rest_factor_.solve(rest).eval();
  for (int k = 0; k < size(); ++k)
    if (const int in_rest = in_rest_[static_cast<std::size_t>(k)]; in_rest >= 0) solution[k] = rest[in_rest];
  for (const Segment& segment : segments_) {
    for (int k = segment.poses - 1; k >= 0; --k) {
      const int pose = segment.first + k;
      const Row& row = factor_[static_cast<std::size_t>(pose)];
      Eigen::Vector3d own = solution.segment<3>(3 * pose);
      if (k + 1 < segment.poses) own -= row.next * solution.segment<3>(3 * pose + 3);
      for (std::size_t b = 0; b < segment.border.size(); ++b)
        own -= rest[segment.border[b]] * row.border.col(static_cast<Eigen::Index>(b));
      solution.segment<3>(3 * pose) = own;
    }
  }
  return solution;
}

double PathMatrix::LogDeterminant() const {
  double sum = rest_size_ > 0 ? rest_factor_.vectorD().array().log().sum() : 0.0;
  for (const Segment& segment : segments_)
    for (int k = 0; k < segment.poses; ++k)
      sum -= std::log(factor_[static_cast<std::size_t>(segment.first + k)].own.determinant());
  return sum;
}

// Backwards through each segment: a pose is what the next one and the border make of it, with an error of its
// own whose covariance is the inverse of its pivot.
PathMatrix::Inverse::Inverse(const PathMatrix& matrix)
    : matrix_(matrix),
      rest_(matrix.rest_factor_),
      own_(matrix.place_.size()),
      next_(matrix.place_.size()),
      border_(matrix.place_.size()) {
  for (const Segment& segment : matrix.segments_) {
    const auto width = static_cast<Eigen::Index>(segment.border.size());
    Eigen::MatrixXd shared(width, width);
    for (Eigen::Index i = 0; i < width; ++i)
      for (Eigen::Index j = 0; j <= i; ++j)
        shared(i, j) = shared(j, i) = rest_.At(segment.border[static_cast<std::size_t>(i)],
                                               segment.border[static_cast<std::size_t>(j)]);
    for (int k = segment.poses - 1; k >= 0; --k) {
      const auto pose = static_cast<std::size_t>(segment.first + k);
      const Row& row = matrix.factor_[pose];
      const bool last = k + 1 == segment.poses;
      Eigen::Matrix3Xd with_border = Eigen::Matrix3Xd::Zero(3, width);
      for (Eigen::Index b = 0; b < width; ++b) {
        for (Eigen::Index c = 0; c < width; ++c) with_border.col(b) -= shared(c, b) * row.border.col(c);
        if (!last) with_border.col(b) -= row.next * border_[pose + 1].col(b);
      }
      next_[pose].setZero();
      own_[pose] = row.own;
      if (!last) {
        next_[pose] = -row.next * own_[pose + 1];
        for (Eigen::Index b = 0; b < width; ++b)
          next_[pose] -= row.border.col(b) * border_[pose + 1].col(b).transpose();
        own_[pose] -= row.next * next_[pose].transpose();
      }
      for (Eigen::Index b = 0; b < width; ++b)
        own_[pose] -= row.border.col(b) * with_border.col(b).transpose();
      border_[pose] = std::move(with_border);
    }
  }
}

double PathMatrix::Inverse::At(int row, int column) const {
  if (row < column) std::swap(row, column);
  const int row_in_rest = matrix_.in_rest_[static_cast<std::size_t>(row)],
            column_in_rest = matrix_.in_rest_[static_cast<std::size_t>(column)];
  if (row_in_rest >= 0 && column_in_rest >= 0) return rest_.At(row_in_rest, column_in_rest);
  const int within = column_in_rest < 0 ? column : row, other = within == column ? row : column;
  const auto pose = static_cast<std::size_t>(within / 3);
  if (const int in_rest = std::max(row_in_rest, column_in_rest); in_rest >= 0) {
    const auto& segment = matrix_.segments_[static_cast<std::size_t>(matrix_.place_[pose].segment)];
    return border_[pose](within % 3, matrix_.InBorder(segment, in_rest));
  }
  return within / 3 == other / 3 ? own_[pose](within % 3, other % 3) : next_[pose](within % 3, other % 3);
}

Eigen::MatrixXd PathMatrix::Inverse::OfShared(int first, int count) const {
  Eigen::MatrixXd of_shared(count, count);
  const int* in_rest = matrix_.in_rest_.data() + matrix_.size() - matrix_.shared_ + first;
  for (int k = 0; k < count; ++k) {
    const Eigen::VectorXd column =
        matrix_.rest_factor_.solve(Eigen::VectorXd::Unit(matrix_.rest_size_, in_rest[k]));
    for (int j = 0; j < count; ++j) of_shared(j, k) = column[in_rest[j]];
  }
  return of_shared;
}

}  // namespace cairn::landmark_map
