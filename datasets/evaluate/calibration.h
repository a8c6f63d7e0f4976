// Whether a result's covariances say how large its errors are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/evaluate/reference.h"
#include "datasets/evaluate/scores.h"
#include "datasets/evaluate/track.h"
#include "schema/geometry.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

// The value that a chi-square of so many degrees of freedom is below with probability p in (0, 1).
double ChiSquareQuantile(double p, int degrees);

// What errors are measured from: a rigid motion lays the result over the truth, or where the true positions
// have a frame of their own a similarity.
struct CalibrationFrame {
  std::string on;           // found from these: "landmarks", "first pose", "poses" or "reference"
  std::int64_t points = 0;  // so many
  std::int64_t dof = 0;     // degrees of freedom of these points' errors that it takes
  bool is_own = true;       // the covariances are stated in this frame
};

// Of landmarks (2 degrees of freedom each), of poses (x, y and heading: 3) or of their positions alone (2).
struct CalibrationScore {
  std::int64_t count = 0;
  std::int64_t within_50 = 0, within_95 = 0;  // in those regions of the normal distributions that were stated
  // Those whose covariance is singular: they claim to be certain, count as within where they are right to a
  // micrometre (microradian), and are not in the NEES. In a frame that is not theirs they claim nothing.
  std::int64_t certain = 0;
  // The mean squared error in units of the covariances, by degree of freedom: 1 where they are right. (NEES:
  // Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001,
  // section 5.4.)
  std::optional<double> nees_per_dof;
  // Where it lies in 99 of 100 such results whose covariances are right, and what that takes for granted.
  std::optional<Interval> nees_99;
  std::string interval_takes;
  CalibrationFrame frame;
};

struct Calibration {
  std::optional<CalibrationScore> landmarks, poses, positions;  // none: no covariances, or no truth
  std::optional<Reference> reference;                           // where it was to be estimated
};

// `matched`: of each of the map's landmarks that has a true one, its index and where the true one is.
// `truth`: each robot's true poses. Covariances of poses are stated among the landmarks, those of landmarks
// in the frame in which they together neither shift nor turn: errors are those after the rigid motion that
// lays the matched landmarks, three at least, over the true ones. But where the landmarks were refined and a
// robot is certain of its first pose, theirs count from there. Where truth does not tell such a frame,
// another one will do: `is_own` is false. `point`: of which point of the robots the true poses are; where it
// is estimated, from them, poses are held against them in their own frame, as FitReference lays it.
Calibration Calibrate(const kinds::LandmarkMap& map,
                      const std::vector<std::pair<std::size_t, Point>>& matched,
                      const std::vector<Track>& truth, const ReferencePoint& point = {});

// Under "calibration", as the page docs/evaluate.md has them.
void AddCalibration(const Calibration& calibration, Scores* scores);

}  // namespace cairn::datasets
