// What a backward task returns, built step by step, and the sum of all of a round's.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_map/e_step.h"
#include "pipelines/landmark_map/plan.h"
#include "pipelines/landmark_map/summary.h"

namespace cairn::landmark_map {

Blob ToBlob(const std::vector<Landmark>& landmarks);
std::vector<Landmark> LandmarksFromBlob(const Blob& blob);

// Fields: counts/…, log_likelihood, work, robot, first, turned_rad and path_m (change of the heading
// correction over the slice's way), first_heading_rad, last_heading_rad, first_path_m (to join it with its
// neighbours); with landmarks also pose/… (a row a step) and association/… (a row an observation of the
// slice).
class PartialBuilder {
 public:
  // `landmarks`: nullptr where no summary is wanted.
  PartialBuilder(const Settings& settings, const Slice& slice, int robot,
                 const std::vector<Landmark>* landmarks, LayeredGrid no_counts);
  // The belief of a step; the last step comes first.
  void Add(int step, const LayeredGrid& belief);
  Blob Finish(const Alphas& alphas) const;

 private:
  void AddAssociations(int step, const LayeredGrid& belief);
  void TrackHeading(int step, const LayeredGrid& belief);

  const Settings& settings_;
  const Slice& slice_;
  int robot_;
  const std::vector<Landmark>* landmarks_;
  LayeredGrid counts_;
  std::vector<PoseSummary> poses_;         // [end - first]
  std::vector<std::int32_t> association_;  // per observation of the slice
  std::vector<double> association_probability_;
  double turned_rad_ = 0.0, path_m_ = 0.0;  // change of the mean heading correction, and the way
  double later_heading_rad_ = 0.0, last_heading_rad_ = 0.0;
  bool has_later_ = false;
};

// Adds up partials, which must come in task order. Counts, likelihood and drift add; summaries are kept.
class RoundSum {
 public:
  RoundSum(LayeredGrid no_counts, std::size_t robots);
  void Add(const Blob& partial);  // `forward` partials and those of empty slices are passed over

  const LayeredGrid& counts() const { return counts_; }
  double log_likelihood() const { return log_likelihood_; }
  double WorkOf(std::size_t robot) const { return work_[robot]; }
  // A robot's heading drift [rad/m] given what its headings did under the drift `so_far`, and a Gaussian
  // prior as wide as the nominal drift.
  double DriftOf(std::size_t robot, const MotionNoise& noise, double so_far) const;
  // The partials of one robot that hold summaries, in the order of steps.
  std::vector<Blob> SummariesOf(std::size_t robot) const;

 private:
  // What a robot's heading corrections did over the slices added so far, the latest first.
  struct Headings {
    bool any = false;
    double turned_rad = 0.0, path_m = 0.0;
    double first_heading_rad = 0.0, first_path_m = 0.0;  // of the earliest slice so far
  };
  static void AddHeadings(const Blob& partial, Headings* sum);

  LayeredGrid counts_;
  double log_likelihood_ = 0.0;
  std::vector<double> work_;
  std::vector<Headings> headings_;
  std::vector<std::vector<Blob>> summaries_;
};

}  // namespace cairn::landmark_map
