// Whether the model explains what was measured: how large errors turned out against what was stated of them,
// and which observations do not fit.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/refinement/least_squares.h"
#include "pipelines/landmark_map/refinement/one_sided.h"
#include "schema/blob.h"

namespace cairn::landmark_map {

// An observation does not fit from so many standard deviations on, along and across its ray together: of a
// thousand Gaussian ones one does.
inline constexpr double kMisfitSigmas = 3.717;

// Of a Gaussian motion in the plane one of sixty thousand.
inline constexpr double kJumpSigmas = 5;

struct ModelFit {
  // Of one kind of error: the stated width, and that which the residuals have.
  struct Width {
    std::string kind;  // "range", "bearing", "contact"
    double stated = 0, found = 0;
  };
  struct Misfit {
    std::int32_t robot = 0;
    double time_s = 0, sigmas = 0;
  };
  std::vector<Width> widths;
  SightingRepeats repeats;
  double tail_sigmas = kCauchySigmas;
  std::int64_t observations = 0, misfits = 0;
  // The longest run of one robot's observations that do not fit, one after the other.
  std::int64_t longest_run = 0;
  double longest_run_from_s = 0;
  // Motions between successive nodes from kJumpSigmas on or broken, and when the worst of them ends.
  std::int64_t odometry_misfits = 0;
  double worst_odometry_s = 0;
  // Where motions are broken: the lead of the map over one with another motion broken; none: there is no such
  // map.
  std::optional<double> break_lead_nats;
  // The fewest landmarks that a robot saw both before and after one time, without a tenth of its observations
  // at either end: where there are none the two halves of its map hang on odometry alone. -1: of no robot.
  std::int64_t fewest_common = -1;
  double fewest_common_s = 0;
  OneSided sides;
  std::vector<Misfit> worst;  // ten at most, the worst first
  // The landmark that most misfits are of, the first of several; -1: there are no misfits.
  std::int32_t misfit_landmark = -1;
  std::int64_t landmark_misfits = 0, landmark_observations = 0;
  std::vector<std::vector<Eigen::Vector2d>>
      off_m;  // of each landmark: from it to where its observations see it

  // As schema/FORMAT.md has it, under `fit/`; without `off_m`. `landmarks`: those that it is of; only the
  // first `types` types have names.
  Blob ToBlob(const std::vector<Landmark>& landmarks, int types) const;
};

// Of the least squares' end. `nominal`: the problem as it was stated; `problem`: with the widths that were
// found.
ModelFit FitOf(const LeastSquaresProblem& nominal, const LeastSquaresProblem& problem,
               const LeastSquaresPoint& point);

}  // namespace cairn::landmark_map
