#include "pipelines/landmark_map/refinement/sensor_shift.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "pipelines/landmark_map/refinement/joint_equations.h"
#include "pipelines/landmark_map/refinement/refined_path.h"
#include "schema/geometry.h"

namespace cairn::landmark_map {
namespace {

// Of a sensor: late_s, x_m, y_m, and the heading of its mount.
using SensorUnknowns = Eigen::Vector4d;
const SensorUnknowns kSmall{0.1, 1e-3, 1e-3, 1e-3}, kMost{10.0, 2.0, 2.0, 0.5};

constexpr int kStepsOfShift = 20;
constexpr double kLeast_nats = 10.0, kLeastEach_nats = 0.02;  // to gain, in all and an observation
constexpr std::size_t kMostSightings = 2000;                  // that many tell it as well as more

// The odometry that a clock would have recorded which is so much later. Between two rows all goes on evenly.
Odometry Later(Odometry odometry, double late_s) {
  const Odometry was = odometry;
  for (std::size_t i = 0; i < was.time_s.size(); ++i) {
    const double time_s = std::clamp(was.time_s[i] - late_s, was.time_s.front(), was.time_s.back());
    const auto after = std::ranges::upper_bound(was.time_s, time_s) - was.time_s.begin();
    const auto k = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after, 1, std::ssize(was.time_s) - 1));
    const double length_s = was.time_s[k] - was.time_s[k - 1];
    const double part = length_s > 0.0 ? (time_s - was.time_s[k - 1]) / length_s : 1.0;
    odometry.x_m[i] = std::lerp(was.x_m[k - 1], was.x_m[k], part);
    odometry.y_m[i] = std::lerp(was.y_m[k - 1], was.y_m[k], part);
    odometry.heading_rad[i] = std::lerp(was.heading_rad[k - 1], was.heading_rad[k], part);
  }
  return odometry;
}

// [N]: the number of the place where each node is; nodes at which a robot stands are at one.
std::vector<int> PlacesOf(const NodeTrack& track) {
  constexpr double kLeast_m = 0.02, kLeast_rad = 0.01;
  std::vector<int> places{0};
  double way_m = 0.0, turn_rad = 0.0;
  for (const std::vector<Control>& controls : track.controls) {
    for (const Control& control : controls) {
      way_m += std::abs(control.forward_m);
      turn_rad += std::abs(control.turn_rad);
    }
    const bool went = way_m >= kLeast_m || turn_rad >= kLeast_rad;
    places.push_back(places.back() + (went ? 1 : 0));
    if (went) way_m = turn_rad = 0.0;
  }
  return places;
}

// One robot's observations, among their landmarks, at other times than they say, or from elsewhere on it.
class RobotAlone {
 public:
  RobotAlone(const LeastSquaresProblem& problem, const LeastSquaresPoint& point, const Odometry& odometry,
             std::size_t robot)
      : odometry_(odometry) {
    LeastSquaresProblem alone = problem;
    alone.robots = {problem.robots[robot]};
    alone.widths = {problem.widths[robot]};
    alone.repeats = {};  // a shift that nobody takes off makes errors that go on
    std::erase_if(alone.sightings,
                  [&](const Sighting& seen) { return seen.robot != static_cast<int>(robot); });
    // From where it stands a landmark looks the same wherever the sensor sits: a thousand sightings tell no
    // more than one, and would leave little of the drive among the first.
    const std::vector<int> places = PlacesOf(alone.robots[0]);
    std::set<std::pair<int, int>> from;
    std::erase_if(alone.sightings, [&](const Sighting& seen) {
      return !from.emplace(places[static_cast<std::size_t>(seen.node)], seen.landmark).second;
    });
    for (Sighting& seen : alone.sightings) seen.robot = 0;
    problem_ = Beginning(alone, kMostSightings);
    std::map<int, int> now;  // its landmarks, in the order in which it sees them
    for (Sighting& seen : problem_.sightings) {
      const auto [at, is_new] = now.try_emplace(seen.landmark, static_cast<int>(now.size()));
      if (is_new) point_.landmarks.push_back(point.landmarks[static_cast<std::size_t>(seen.landmark)]);
      seen.landmark = at->second;
    }
    problem_.landmarks = static_cast<int>(now.size());
    point_.nodes = {point.nodes[robot]};
    point_.nodes[0].resize(problem_.robots[0].time_s.size());
    point_.errors = {point.errors[robot]};
  }

  const LeastSquaresPoint& point() const { return point_; }
  const std::vector<Sighting>& sightings() const { return problem_.sightings; }

  LeastSquaresProblem Under(const SensorUnknowns& shift) const {
    LeastSquaresProblem shifted = problem_;
    for (Sighting& seen : shifted.sightings) seen = Mounted(seen, shift);
    if (shift[0] == 0.0) return shifted;
    const Odometry later = Later(odometry_, shift[0]);
    NodeTrack& track = shifted.robots[0];
    for (std::size_t k = 0; k < track.controls.size(); ++k)
      track.controls[k] = ControlsBetween(later, track.time_s[k], track.time_s[k + 1]);
    return shifted;
  }
  static Sighting Mounted(Sighting seen, const SensorUnknowns& shift) {
    if (seen.contact()) return seen;
    const Pose place = Compose({shift[1], shift[2], shift[3]}, {seen.x_m, seen.y_m, 0});
    seen.x_m = place.x_m;
    seen.y_m = place.y_m;
    return seen;
  }

 private:
  LeastSquaresProblem problem_;
  LeastSquaresPoint point_;
  const Odometry& odometry_;
};

// A step of Gauss and Newton in which the shift moves with all other unknowns, which are eliminated: of the
// normal equations about a point the shift's own part is left (its Schur complement).
class ShiftEquations {
 public:
  ShiftEquations(const RobotAlone& shifted, const SensorUnknowns& at, const LeastSquaresPoint& point)
      : problem_(shifted.Under(at)), point_(point), equations_(problem_, point) {
    constexpr double kDamping = 1e-6;
    equations_.Evaluate(point, true);
    cross_ = Eigen::MatrixX4d::Zero(equations_.layout().size(), 4);
    AddEdges(shifted, at);
    for (const Sighting& seen : shifted.sightings()) AddSighting(seen, at);
    solved_ = equations_.Factorise(kDamping);
    if (!solved_) return;
    rest_ = equations_.matrix().Solve(equations_.gradient());
    by_shift_.resize(cross_.rows(), 4);
    for (int i = 0; i < 4; ++i) by_shift_.col(i) = equations_.matrix().Solve(cross_.col(i));
    for (int i = 0; i < 4; ++i) {
      gradient_[i] -= cross_.col(i).dot(rest_);
      for (int k = 0; k < 4; ++k) matrix_(i, k) -= cross_.col(i).dot(by_shift_.col(k));
    }
  }

  // Of the `count` parts of the shift from `first` on; the others stay.
  SensorUnknowns Step(int first, int count) const {
    SensorUnknowns step = SensorUnknowns::Zero();
    if (!solved_) return step;
    const Eigen::LLT<Eigen::MatrixXd> solver(matrix_.block(first, first, count, count));
    if (solver.info() == Eigen::Success)
      step.segment(first, count) = -solver.solve(gradient_.segment(first, count));
    return step;
  }
  // What that step promises.
  double Gain(int first, int count) const { return -0.5 * gradient_.dot(Step(first, count)); }
  // How well the observations tell where the sensor sits, with its heading: the larger standard deviation.
  double PlaceSd_m() const {
    const Eigen::Matrix3d covariance = matrix_.block<3, 3>(1, 1).inverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> of(covariance.topLeftCorner<2, 2>());
    const double most = of.eigenvalues()[1];
    return solved_ && of.eigenvalues()[0] > 0.0 && std::isfinite(most) ? std::sqrt(most) : kMost[1];
  }
  // Where all else then is.
  LeastSquaresPoint Moved(const SensorUnknowns& step) const {
    return equations_.layout().Moved(point_, -rest_ - by_shift_ * step);
  }

 private:
  void AddEdges(const RobotAlone& shifted, const SensorUnknowns& at) {
    const SensorUnknowns late = SensorUnknowns::Unit(0) * kSmall[0];
    const LeastSquaresProblem up = shifted.Under(at + late), down = shifted.Under(at - late);
    const JointEquations later(up, point_), sooner(down, point_);
    for (std::size_t k = 0; k < problem_.robots[0].controls.size(); ++k) {
      Eigen::Matrix<double, 3, 4> by = Eigen::Matrix<double, 3, 4>::Zero();
      by.col(0) = (later.Edge(point_, 0, k).error - sooner.Edge(point_, 0, k).error) / (2.0 * kSmall[0]);
      const JointEquations::EdgeTerm term = equations_.Edge(point_, 0, k);
      Add<3, 9>(term.by, term.at, by, term.error, equations_.Weight(0, k));
    }
  }
  void AddSighting(const Sighting& seen, const SensorUnknowns& at) {
    const auto term_under = [&](const SensorUnknowns& shift) {
      return equations_.Seen(point_, RobotAlone::Mounted(seen, shift));
    };
    const JointEquations::SightingTerm term = term_under(at);
    Eigen::Matrix<double, 2, 4> by = Eigen::Matrix<double, 2, 4>::Zero();
    for (int i = 1; i < 4; ++i) {
      const SensorUnknowns small = SensorUnknowns::Unit(i) * kSmall[i];
      by.col(i) =
          (term_under(at + small).residual.error - term_under(at - small).residual.error) / (2.0 * kSmall[i]);
    }
    const double weight = equations_.Weight(term.residual, seen);
    Add<2, 6>(term.by, term.at, by, term.residual.error,
              Eigen::Matrix2d(weight * Eigen::Matrix2d::Identity()));
  }
  template <int kErrors, int kUnknowns>
  void Add(const Eigen::Matrix<double, kErrors, kUnknowns>& by_unknown, const std::array<int, kUnknowns>& at,
           const Eigen::Matrix<double, kErrors, 4>& by_shift, const Eigen::Matrix<double, kErrors, 1>& error,
           const Eigen::Matrix<double, kErrors, kErrors>& weight) {
    const Eigen::Matrix<double, kErrors, 4> weighted = weight * by_shift;
    gradient_ += weighted.transpose() * error;
    matrix_ += weighted.transpose() * by_shift;
    const Eigen::Matrix<double, kUnknowns, 4> cross = by_unknown.transpose() * weighted;
    for (int k = 0; k < kUnknowns; ++k) cross_.row(at[k]) += cross.row(k);
  }

  LeastSquaresProblem problem_;
  const LeastSquaresPoint& point_;
  JointEquations equations_;
  bool solved_ = false;
  Eigen::MatrixX4d cross_, by_shift_;
  Eigen::VectorXd rest_;
  SensorUnknowns gradient_ = SensorUnknowns::Zero();
  Eigen::Matrix4d matrix_ = Eigen::Matrix4d::Zero();
};

struct LeastShift {
  SensorUnknowns at = SensorUnknowns::Zero();
  LeastSquaresEnd end;
};

// Where the cost is least, by such steps as long as it falls, each twice as far while that explains more: the
// noise of odometry makes the slope along lateness uneven.
LeastShift FindLeastShift(const RobotAlone& shifted, LeastShift least, int first, int count) {
  constexpr int kRounds = 6;
  const double none = least.end.cost;
  for (int round = 0; round < kRounds; ++round) {
    const LeastShift from = least;
    const ShiftEquations equations(shifted, from.at, from.end.point);
    for (SensorUnknowns step = equations.Step(first, count);; step *= 2.0) {
      const SensorUnknowns at = (from.at + step).cwiseMin(kMost).cwiseMax(-kMost);
      if (at == least.at) break;
      LeastSquaresEnd there =
          Descend(shifted.Under(at), equations.Moved(at - from.at), kStepsOfShift, kNearTheLeast);
      if (!(there.cost < least.end.cost)) break;
      least = {at, std::move(there)};
    }
    if (from.end.cost - least.end.cost < std::max(0.5, 0.05 * (none - least.end.cost))) break;
  }
  return least;
}

// A robot that hardly turns sees the same from anywhere: then a place explains what something else is about.
bool TellsThePlace(const RobotAlone& shifted, const LeastShift& mount) {
  constexpr double kKnown_m = 0.1;
  const bool is_at_the_end = (mount.at.cwiseAbs().array() >= kMost.array()).any();
  return !is_at_the_end && ShiftEquations(shifted, mount.at, mount.end.point).PlaceSd_m() <= kKnown_m;
}

SensorShift ShiftOf(const RobotAlone& shifted) {
  constexpr double kWorthALook = 0.3;  // of what is to gain
  const double enough =
      std::max(kLeast_nats, kLeastEach_nats * static_cast<double>(shifted.sightings().size()));
  const ShiftEquations equations(shifted, SensorUnknowns::Zero(), shifted.point());
  const double late_promises = equations.Gain(0, 1), mount_promises = equations.Gain(1, 3);
  if (std::max(late_promises, mount_promises) <= kWorthALook * enough) return {};
  const LeastShift as_is{SensorUnknowns::Zero(), Descend(shifted.Under(SensorUnknowns::Zero()),
                                                         shifted.point(), kStepsOfShift, kNearTheLeast)};
  const auto look = [&](int first, int count, double promises, double least) {
    return promises > kWorthALook * std::max(enough, least) ? FindLeastShift(shifted, as_is, first, count)
                                                            : as_is;
  };
  const auto gain = [&](const LeastShift& found) { return as_is.end.cost - found.end.cost; };
  const LeastShift late = look(0, 1, late_promises, mount_promises);
  LeastShift mount = look(1, 3, mount_promises, gain(late));
  if (!TellsThePlace(shifted, mount)) mount = FindLeastShift(shifted, as_is, 3, 1);
  // What explains more: the one may look like a little of the other.
  if (std::max(gain(mount), gain(late)) < enough) return {};
  if (gain(late) >= gain(mount)) return {late.at[0]};
  const LeastShift turned = FindLeastShift(shifted, as_is, 3, 1);
  if (gain(mount) - gain(turned) < enough) return {0, -turned.at[3]};
  return {0, -mount.at[3], mount.at[1], mount.at[2]};
}

}  // namespace

std::vector<SensorShift> FindSensorShifts(const LeastSquaresProblem& problem, const LeastSquaresPoint& point,
                                          std::span<const Odometry> odometry) {
  std::vector<SensorShift> shifts(odometry.size());
  for (std::size_t r = 0; r < odometry.size(); ++r) {
    const RobotAlone shifted(problem, point, odometry[r], r);
    if (!shifted.sightings().empty()) shifts[r] = ShiftOf(shifted);
  }
  return shifts;
}

}  // namespace cairn::landmark_map
