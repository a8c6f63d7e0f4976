// The normal equations of paths among landmarks: chains of poses, each coupled with the next and with some of
// what all share. Cut into segments, the poses within a segment are eliminated one after the other, which
// takes dense arithmetic on few rows; the poses between segments and what all share are left to a sparse
// Cholesky factor (nested dissection, A. George, 1973).
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "pipelines/landmark_map/refinement/selected_inverse.h"

namespace cairn::landmark_map {

// A symmetric matrix. Its unknowns: three of each pose, chain after chain; then those that are shared.
class PathMatrix {
 public:
  // Of a pose, counted over all chains, with a shared unknown, counted from 0.
  struct Coupling {
    int pose = 0, shared = 0;
  };
  static constexpr int kSegmentPoses = 32;

  // `couplings`: all that will be added, in any order, and as often as one likes.
  PathMatrix(std::span<const int> chain_poses, int shared, std::span<const Coupling> couplings,
             int segment_poses = kSegmentPoses);

  int size() const { return static_cast<int>(in_rest_.size()); }
  void SetZero();
  // To the entry and its mirror image. Of two poses, those of one or of neighbours in a chain.
  void Add(int row, int column, double value);
  Eigen::VectorXd Diagonal() const;

  // Of the matrix with its diagonal raised by a share of itself. False: it is not positive definite.
  bool Factorise(double damping);
  // By the factor made last.
  Eigen::VectorXd Solve(const Eigen::VectorXd& right_side) const;
  // Of the matrix factorised last.
  double LogDeterminant() const;

  // Entries of the inverse of the matrix factorised last, where entries can be added.
  class Inverse {
   public:
    explicit Inverse(const PathMatrix& matrix);
    double At(int row, int column) const;
    // Of the shared unknowns from `first` on: all of them with one another, whether entries can be added or
    // not.
    Eigen::MatrixXd OfShared(int first, int count) const;

   private:
    const PathMatrix& matrix_;
    SelectedInverse rest_;
    std::vector<Eigen::Matrix3d> own_, next_;  // of each pose within a segment: with itself, with the next
    std::vector<Eigen::Matrix3Xd> border_;     // with what its segment meets
  };

 private:
  // Where a pose stands: within a segment, or (-1) between two, its unknowns then from `at` on in the rest.
  struct Place {
    int segment = -1, at = 0;
  };
  // Poses from `first` on that no other segment meets, and the unknowns of the rest that they meet: three of
  // the pose before, three of the pose after, then of the shared ones.
  struct Segment {
    int first = 0, poses = 0;
    std::vector<int> border;
    std::vector<int> shared_at;  // of each shared unknown, in `border`; -1: not in it
  };
  // Of a pose within a segment. Once factorised: the inverse of its pivot, and with that multiplied what
  // couples it with the next pose and with the border.
  struct Row {
    Eigen::Matrix3d own, next;
    Eigen::Matrix3Xd border;
  };

  int InBorder(const Segment& segment, int in_rest) const;
  bool Eliminate(const Segment& segment, double damping);

  int shared_ = 0, rest_size_ = 0;
  std::vector<Place> place_;  // of each pose
  std::vector<int> in_rest_;  // of each unknown; -1: of a pose within a segment
  std::vector<Segment> segments_;
  std::vector<Row> rows_, factor_;  // of each pose; empty of those between segments
  std::vector<Eigen::Triplet<double>> rest_, reduced_;
  SparseFactor rest_factor_;
};

}  // namespace cairn::landmark_map
