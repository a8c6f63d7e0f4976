#include "pipelines/landmark_map/refinement/sensor_shift.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "pipelines/landmark_map/refinement/joint_equations.h"
#include "pipelines/landmark_map/refinement/refined_path.h"
#include "pipelines/landmark_map/refinement/width_estimate.h"
#include "schema/geometry.h"
#include "schema/middle.h"

namespace cairn::landmark_map {
namespace {

// Of a sensor: late_s, x_m, y_m, and the heading of its mount.
using SensorUnknowns = Eigen::Vector4d;
const SensorUnknowns kSmall{0.1, 1e-3, 1e-3, 1e-3}, kMost{10.0, 2.0, 2.0, 0.5};

constexpr int kStepsOfShift = 20;
constexpr double kLeast_nats = 10.0, kLeastEach_nats = 0.02;  // to gain, in all and an observation
constexpr std::size_t kMostSightings = 2000;                  // that many tell it as well as more

// Where a robot is by its odometry, at times that are all different: several rows of one time are one motion.
struct Reckoned {
  std::vector<double> time_s;
  std::vector<Pose> at;

  explicit Reckoned(const Odometry& odometry) {
    for (std::size_t i = 0; i < odometry.time_s.size(); ++i) {
      const Pose pose{odometry.x_m[i], odometry.y_m[i], odometry.heading_rad[i]};
      if (!time_s.empty() && odometry.time_s[i] <= time_s.back()) {
        at.back() = pose;
        continue;
      }
      time_s.push_back(odometry.time_s[i]);
      at.push_back(pose);
    }
  }

  // Between two times all goes on evenly; the heading is not wrapped.
  Pose At(double time) const {
    const auto after = std::ranges::upper_bound(time_s, time) - time_s.begin();
    if (after == 0 || after == std::ssize(time_s)) return after == 0 ? at.front() : at.back();
    const auto k = static_cast<std::size_t>(after);
    const double part = (time - time_s[k - 1]) / (time_s[k] - time_s[k - 1]);
    return {std::lerp(at[k - 1].x_m, at[k].x_m, part), std::lerp(at[k - 1].y_m, at[k].y_m, part),
            std::lerp(at[k - 1].heading_rad, at[k].heading_rad, part)};
  }
};

// The odometry that a clock would have recorded which is so much later. From one time to the next it turns to
// where it goes, goes there, and turns on; one that ever goes aside (common/odometry.h) does so here.
Odometry Later(const Odometry& was, double late_s) {
  const bool goes_aside = std::ranges::any_of(was.aside_rad, [](double rad) { return rad != 0.0; });
  const Reckoned reckoned(was);
  Odometry later;
  const auto add = [&](double time_s, const Pose& at, double heading_rad, double aside_rad = 0.0) {
    later.time_s.push_back(time_s);
    later.aside_rad.push_back(aside_rad);
    later.x_m.push_back(at.x_m);
    later.y_m.push_back(at.y_m);
    later.heading_rad.push_back(heading_rad);
  };
  Pose before = reckoned.At(reckoned.time_s.front() - late_s);
  add(reckoned.time_s.front(), before, before.heading_rad);
  for (std::size_t i = 1; i < reckoned.time_s.size(); ++i) {
    constexpr double kStands_m = 1e-6;
    const Pose at = reckoned.At(reckoned.time_s[i] - late_s);
    const double dx = at.x_m - before.x_m, dy = at.y_m - before.y_m;
    const double middle = 0.5 * (before.heading_rad + at.heading_rad);
    // Ahead or backwards.
    double off = std::remainder(std::atan2(dy, dx) - middle, std::numbers::pi);
    if (std::hypot(dx, dy) < kStands_m) off = 0.0;
    if (goes_aside && GoesAside(before.heading_rad, middle + off, at.heading_rad))
      add(reckoned.time_s[i], at, middle, off);
    else
      add(reckoned.time_s[i], at, middle + off);
    add(reckoned.time_s[i], at, at.heading_rad);
    before = at;
  }
  return later;
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
             const EdgeWidths& expected, std::size_t robot)
      : expected_{expected},
        odometry_(odometry),
        row_s_(MiddlePause(std::span(odometry.time_s), 1).value_or(0.0)) {
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
  // What was expected of its odometry's widths, [1], and those that its problems have.
  const std::vector<EdgeWidths>& expected() const { return expected_; }
  void SetWidths(const EdgeWidths& widths) { problem_.widths = {widths}; }
  double row_s() const { return row_s_; }  // as long as a row of its odometry usually is
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
  std::vector<EdgeWidths> expected_;
  const Odometry& odometry_;
  double row_s_;
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

// A shift with the widths of odometry that go with it: estimated without it they take up what it leaves.
struct Model {
  LeastShift shift;
  EdgeWidths widths;
  double nats = std::numeric_limits<double>::infinity();  // NegativeLogEvidence
};

Model ModelOf(const RobotAlone& shifted, const LeastShift& shift) {
  LeastSquaresProblem problem = shifted.Under(shift.at);
  Model model{shift, problem.widths[0]};
  if (!SettleOdometryWidths(shifted.expected(), &problem, &model.shift.end)) return model;
  model.widths = problem.widths[0];
  model.nats = NegativeLogEvidence(shifted.expected(), problem, model.shift.end.point);
  return model;
}

// Narrower widths tell the lateness better, and that makes them narrower again.
Model SettledLateness(RobotAlone shifted, const LeastShift& late) {
  constexpr int kRounds = 3;
  constexpr double kSettled_s = 0.01;
  Model model = ModelOf(shifted, late);
  for (int round = 0; round < kRounds && std::isfinite(model.nats); ++round) {
    shifted.SetWidths(model.widths);
    const LeastShift from{model.shift.at, Descend(shifted.Under(model.shift.at), model.shift.end.point,
                                                  kStepsOfShift, kNearTheLeast)};
    Model next = ModelOf(shifted, FindLeastShift(shifted, from, 0, 1));
    const double change_s = std::abs(next.shift.at[0] - model.shift.at[0]);
    if (next.nats < model.nats) model = std::move(next);
    if (change_s < kSettled_s) break;
  }
  return model;
}

SensorShift ShiftOf(const RobotAlone& shifted) {
  constexpr double kWorthALook = 0.3;  // of what is to gain
  constexpr double kTied_nats = 3.0, kOfARow = 0.5;
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
  LeastShift late = look(0, 1, late_promises, mount_promises);
  LeastShift mount = look(1, 3, mount_promises, gain(late));
  if (!TellsThePlace(shifted, mount)) mount = FindLeastShift(shifted, as_is, 3, 1);
  // Where odometry was between two rows nobody knows.
  if (std::abs(late.at[0]) <= kOfARow * shifted.row_s()) late = as_is;
  // What explains more: the one may look like a little of the other.
  if (std::max(gain(mount), gain(late)) < enough) return {};
  SensorShift found;
  double ahead_nats = gain(late) - gain(mount);
  if (gain(late) >= kWorthALook * enough) {
    const Model model = SettledLateness(shifted, late);
    ahead_nats = ModelOf(shifted, mount).nats - model.nats;
    late = model.shift;
  }
  const bool mount_explains = gain(mount) >= enough;
  if (ahead_nats > -kTied_nats || !mount_explains) found.late_s = late.at[0];
  if (ahead_nats >= kTied_nats || !mount_explains) return found;
  const LeastShift turned = FindLeastShift(shifted, as_is, 3, 1);
  if (gain(mount) - gain(turned) < enough) mount = turned;
  found.turned_rad = -mount.at[3];
  found.x_m = mount.at[1];
  found.y_m = mount.at[2];
  return found;
}

}  // namespace

std::vector<SensorShift> FindSensorShifts(const LeastSquaresProblem& problem, const LeastSquaresPoint& point,
                                          std::span<const Odometry> odometry,
                                          std::span<const EdgeWidths> expected) {
  std::vector<SensorShift> shifts(odometry.size());
  for (std::size_t r = 0; r < odometry.size(); ++r) {
    const RobotAlone shifted(problem, point, odometry[r], expected[r], r);
    if (!shifted.sightings().empty()) shifts[r] = ShiftOf(shifted);
  }
  return shifts;
}

}  // namespace cairn::landmark_map
