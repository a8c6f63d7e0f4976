// Joint least squares over the poses of all robots, the landmarks, and what each robot's odometry errs by all
// along.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "pipelines/landmark_map/model/sensing.h"
#include "pipelines/landmark_map/refinement/motion_edge.h"

namespace cairn::landmark_map {

// A robot's nodes, in the order of time, and the controls from each to the next.
struct NodeTrack {
  std::vector<double> time_s;                  // [N]
  std::vector<std::vector<Control>> controls;  // [N - 1]
  std::vector<std::size_t> broken;             // the edges of which odometry tells nothing

  bool IsBroken(std::size_t edge) const { return std::ranges::find(broken, edge) != broken.end(); }
};

// A landmark seen from a node.
struct Sighting {
  int robot = 0, node = 0, landmark = 0;
  double x_m = 0.0, y_m = 0.0;  // from the robot, in its own frame; (0, 0): a contact detection
  bool contact() const { return x_m == 0.0 && y_m == 0.0; }
};
// Where it sees the landmark from its node, its range being `offset_m` too long.
Eigen::Vector2d PlaceSeen(const Eigen::Vector3d& node, const Sighting& seen, double offset_m = 0.0);

// Standard deviations of one robot's odometry: of its heading's random walk, of turns, of ways.
struct EdgeWidths {
  double walk_rad_per_sqrt_m = 0.0, turn_rad_per_sqrt_rad = 0.0, way_m_per_sqrt_m = 0.0;
};

// Scales of Cauchy priors of SystematicErrors: wide ones have heavy tails. 0: there is no such error.
struct SystematicPriors {
  double drift_rad_per_m = 0.0, way = 0.0, turn = 0.0, range_m = 0.0;
};

// What one sighting errs by the next one of the same landmark errs by, too, where a sensor is not calibrated
// or a landmark is no point: so many sightings tell as much as one whose errors are its own.
struct SightingRepeats {
  double along = 1.0, across = 1.0;
};

// A sighting may be of anything: its tails are as heavy as a Cauchy's from so many standard deviations on,
// unless all of them show lighter ones (TailOf).
inline constexpr double kCauchySigmas = 3.0;

struct LeastSquaresProblem {
  std::vector<NodeTrack> robots;
  std::vector<Sighting> sightings;  // of one robot in the order of nodes
  int landmarks = 0;
  bool named = false;              // all of them, so that it is certain which a sighting is of
  std::vector<EdgeWidths> widths;  // [robots]
  Eigen::Vector3d loose = Eigen::Vector3d::Zero();  // variances of each motion besides: m^2, m^2, rad^2
  ObservationNoise noise;
  SightingRepeats repeats;
  double tail_sigmas = kCauchySigmas;  // from where on sightings have tails as heavy as a Cauchy's
  SystematicPriors priors;
};

// With the first so many sightings alone, and of each robot the nodes up to the last of them.
LeastSquaresProblem Beginning(const LeastSquaresProblem& whole, std::size_t sightings);

// A point in the space of the unknowns.
struct LeastSquaresPoint {
  std::vector<std::vector<Eigen::Vector3d>> nodes;  // of each robot: x, y, heading, unwrapped along the track
  std::vector<Eigen::Vector2d> landmarks;
  std::vector<SystematicErrors> errors;  // of each robot
};

// The logarithm of what makes exp(-cost) of a sighting a density, but for its widths and 2 pi.
double LogTailNorm(double tail_sigmas);

// Of an edge's motion.
Eigen::Matrix3d CovarianceOf(const EdgeSpread& spread, const EdgeWidths& widths);

// Where its nodes are by odometry alone, from the first one on.
std::vector<Eigen::Vector3d> DeadReckoned(const NodeTrack& track, const Eigen::Vector3d& first,
                                          const SystematicErrors& errors);

// Minus the logarithm of the point's probability, up to a constant [nats], under the problem's widths and
// tails.
double CostOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& point);

// The least that Levenberg and Marquardt's steps come to from `start`. The first robot's first pose stays
// where it is.
struct LeastSquaresEnd {
  LeastSquaresPoint point;
  double cost = 0.0;
  int steps = 0;
  bool settled = false;  // no step promises more than a thousandth of a nat and `share` of the cost
};
// Shares of the cost: where nothing more changes, and near enough to go on otherwise. A large problem's least
// lies no lower than its noise.
inline constexpr double kAtTheLeast = 1e-5, kNearTheLeast = 1e-4;
LeastSquaresEnd Descend(const LeastSquaresProblem& problem, const LeastSquaresPoint& start,
                        int most_steps = 50, double share = kAtTheLeast);

// How many standard deviations each sighting is off, along its ray and across it together.
std::vector<double> SightingSigmas(const LeastSquaresProblem& problem, const LeastSquaresPoint& point);
// The same of each robot's motions from node to node, in all three of their errors together.
std::vector<std::vector<double>> EdgeSigmas(const LeastSquaresProblem& problem,
                                            const LeastSquaresPoint& point);
// From each landmark to where its sightings see it [m].
std::vector<std::vector<Eigen::Vector2d>> SightingErrors_m(const LeastSquaresProblem& problem,
                                                           const LeastSquaresPoint& point);

}  // namespace cairn::landmark_map
