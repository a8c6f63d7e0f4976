// What a backward task returns, built step by step, and the sum of all of a round's.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/model/e_step.h"
#include "pipelines/landmark_map/model/odometry_fit.h"
#include "pipelines/landmark_map/state/nearby_start.h"
#include "pipelines/landmark_map/state/schedule.h"

namespace cairn::landmark_map {

// Where a step's belief has a robot on average: for people to look at.
struct PathPoint {
  std::int32_t robot = 0;
  double time_s = 0, x_m = 0, y_m = 0;
  static void Fields(const auto& field) {
    field("robot", &PathPoint::robot);
    field("time_s", &PathPoint::time_s);
    field("x_m", &PathPoint::x_m);
    field("y_m", &PathPoint::y_m);
  }
};

// Fields: counts/…, increments/…, path/… (a row a step, of long logs every so many), log_likelihood, work,
// robot, first, first_path_m (distance travelled to the slice's first step); with landmarks also pose/… (a
// row a step), association/… (a row an observation of the slice) and, where they are kept, belief/… (a layer
// a step, added up over headings).
class PartialBuilder {
 public:
  // `landmarks`: nullptr where no summary is wanted.
  PartialBuilder(const Settings& settings, const Slice& slice, int robot,
                 const std::vector<Landmark>* landmarks, LayeredGrid no_counts);
  // Beliefs too are part of the summary.
  void KeepBeliefs();
  // Where the robot may have started is kept: start/… (a row a heading).
  void KeepStart() { keeps_start_ = true; }
  // The belief of a step; the last step comes first.
  void Add(int step, const LayeredGrid& belief);
  // The motion increment that leads to a step, after the step's belief.
  void AddIncrement(int step, const HalfTurn& posterior);
  Blob Finish(const Alphas& alphas) const;
  const LayeredGrid& counts() const { return counts_; }

 private:
  double ReachOf(int type) const;
  void AddAssociations(int step, const LayeredGrid& belief);
  double HeadingOf(const LayeredGrid& belief) const;

  const Settings& settings_;
  const Slice& slice_;
  int robot_;
  const std::vector<Landmark>* landmarks_;
  LayeredGrid counts_;
  std::vector<PathPoint> path_;
  bool keeps_start_ = false;
  std::vector<StartBox> start_;
  std::vector<PoseSummary> poses_;         // [end - first]
  LayeredGrid beliefs_;                    // [end - first], or empty where they are not kept
  std::vector<std::int32_t> association_;  // per observation of the slice
  std::vector<double> association_probability_;
  IncrementSums increments_;
};

// An array of summaries, one after the other.
std::vector<double> Joined(const std::vector<Blob>& summaries, const char* name);

// Which landmark each observation of a robot's steps is of.
struct Associated {
  std::vector<std::int32_t> landmark;
  std::vector<double> probability;
};
Associated AssociatedIn(const std::vector<Blob>& summaries);

// Copies, for which nothing that lies beside them in memory need stay there.
Blob CopyOf(const Blob& blob);
// Copies of a partial's pose/…, association/…, belief/… and first.
Blob SummaryOf(const Blob& partial);
// What workers made of a robot's steps, in their order.
// Throws InputError where it is not of all of them and of all observations, a pose is none, or an observation
// is of a landmark that is none of so many.
void CheckSummaries(const std::vector<Blob>& summaries, const RobotSteps& steps, std::size_t landmarks);

// Throws InputError where these are no expected counts of such a map.
void CheckCounts(const LayeredGrid& counts, const MapRules& rules);

// Adds up partials one by one, which must come in task order: nothing of a partial's tables is kept. Counts,
// likelihood and motion increments add; summaries are kept, but not stored.
class RoundSum {
 public:
  RoundSum(const Settings& settings, std::size_t robots);
  // Partials of tasks other than `backward`, and of empty slices, are passed over.
  // Throws InputError where a figure cannot be, or the counts would need more memory than is allowed.
  void Add(const Blob& partial);
  Blob ToBlob() const;
  // Throws InputError where it is none of such robots, or of another map's layers.
  static RoundSum FromBlob(const Settings& settings, const Blob& blob, std::size_t robots);

  const LayeredGrid& counts() const { return counts_; }
  double log_likelihood() const { return log_likelihood_; }
  double log_likelihood_of(std::size_t robot) const { return log_likelihood_of_[robot]; }
  double WorkOf(std::size_t robot) const { return work_[robot]; }
  const std::vector<IncrementSums>& increments() const { return increments_; }  // per robot
  const std::vector<PathPoint>& path() const { return path_; }                  // in no order
  // Where a robot may have started, of those whose start is kept.
  std::vector<StartBox> StartOf(std::size_t robot) const;
  // Slices that were guessed, and those of them that were guessed right.
  std::int64_t guessed(std::size_t robot) const { return guessed_[robot]; }
  std::int64_t confirmed(std::size_t robot) const { return confirmed_[robot]; }
  // The partials of one robot that hold summaries, in the order of steps.
  std::vector<Blob> SummariesOf(std::size_t robot) const;
  // All but the summaries.
  static void Fields(const auto& field) {
    field("counts", &RoundSum::counts_);
    field("log_likelihood", &RoundSum::log_likelihood_);
    field("log_likelihood_of", &RoundSum::log_likelihood_of_);
    field("work", &RoundSum::work_);
    field("increments", &RoundSum::increments_);
    field("guessed", &RoundSum::guessed_);
    field("confirmed", &RoundSum::confirmed_);
    field("first_path_m", &RoundSum::first_path_m_);
    field("path", &RoundSum::path_);
    field("start", &RoundSum::start_);
  }

 private:
  void Check() const;

  MapRules rules_;
  double memory_mb_;
  LayeredGrid counts_;
  double log_likelihood_ = 0.0;
  std::vector<double> log_likelihood_of_;
  std::vector<double> work_;
  std::vector<IncrementSums> increments_;
  std::vector<double> first_path_m_;  // per robot: distance travelled to the earliest step so far
  std::vector<PathPoint> path_;
  std::vector<StartBox> start_;
  std::vector<std::vector<Blob>> summaries_;
  std::vector<std::int64_t> guessed_, confirmed_;  // per robot
};

}  // namespace cairn::landmark_map
