// The M-step of the motion model: how far a robot's odometry drifts and errs, from what the E-step says that
// its headings did. The paper takes the motion model as given; its log-likelihood says which one was right.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipelines/common/motion.h"
#include "schema/blob.h"
#include "schema/kinds/fields.h"

namespace cairn::landmark_map {

// What is known of one robot's odometry.
struct OdometryFit {
  double drift_rad_per_m = 0.0;  // taken off its odometry
  double heading_walk_rad_per_sqrt_m = 0.0;
  double turn_ratio = 0.0;

  static void Fields(const auto& field) {
    field("drift_rad_per_m", &OdometryFit::drift_rad_per_m);
    field("heading_walk_rad_per_sqrt_m", &OdometryFit::heading_walk_rad_per_sqrt_m);
    field("turn_ratio", &OdometryFit::turn_ratio);
  }
  static OdometryFit Of(const MotionNoise& nominal) {
    return {0.0, nominal.heading_walk_rad_per_sqrt_m, nominal.turn_ratio};
  }
  // Throws InputError where a figure is none that a fit can give.
  void Check() const;
  // The noise parameters with these widths in their places.
  MotionNoise Widths(MotionNoise nominal) const;
};

// What the data say of one source of errors: errors squared, in units of the variance that the E-step took
// for granted, and how many errors' worth of them the data have told. In equal numbers: the variance was
// right.
struct WidthEvidence {
  double squares = 0.0, known = 0.0;
  static void Fields(const auto& field) {
    field("squares", &WidthEvidence::squares);
    field("known", &WidthEvidence::known);
  }
};

// Sums over motion increments, the latest motion increment first; slices of a robot join.
class IncrementSums {
 public:
  // The mean of a step's heading correction; `next_path_m`: distance from it to the step after it, which came
  // before.
  void AddHeading(double heading_rad, double next_path_m);
  // One motion increment's posterior under the widths that made its kernel.
  void AddIncrement(const MotionIncrement& increment, const HalfTurn& posterior, const MotionNoise& widths);
  // `earlier`: of the slice before this one; `link_path_m`: distance from its last step to this one's first.
  void Join(const IncrementSums& earlier, double link_path_m);

  double path_m() const { return path_m_; }
  // By how much the heading correction changed over that way.
  double turned_rad() const { return turned_rad_; }
  const WidthEvidence& walk() const { return walk_; }
  const WidthEvidence& turn() const { return turn_; }

  static void Fields(const auto& field) {
    field("any", &IncrementSums::any_);
    field("turned_rad", &IncrementSums::turned_rad_);
    field("path_m", &IncrementSums::path_m_);
    field("first_rad", &IncrementSums::first_rad_);
    field("last_rad", &IncrementSums::last_rad_);
    field("walk", &IncrementSums::walk_);
    field("turn", &IncrementSums::turn_);
  }

 private:
  bool any_ = false;
  double turned_rad_ = 0.0, path_m_ = 0.0;
  double first_rad_ = 0.0, last_rad_ = 0.0;  // heading corrections at both ends
  WidthEvidence walk_, turn_;
};

// A robot's heading drift [rad/m] given what its headings did under the drift `so_far`, and a Gaussian prior
// as wide as the nominal drift.
double FitDrift(const IncrementSums& sums, const MotionNoise& nominal, double so_far);

// New widths for every robot from the sums of those that took part (the others' are empty). A prior of
// kPriorIncrements motion increments that erred as the noise parameters say holds the mean over all robots,
// and one of as many motion increments that erred as that mean each robot. A width at most doubles or halves
// at a time, and never falls below a third of the nominal one.
inline constexpr double kPriorIncrements = 20.0;
void FitWidths(const std::vector<IncrementSums>& sums, const MotionNoise& nominal,
               std::vector<OdometryFit>* fits);

}  // namespace cairn::landmark_map
