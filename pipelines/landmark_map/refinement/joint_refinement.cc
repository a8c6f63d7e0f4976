#include "pipelines/landmark_map/refinement/joint_refinement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "pipelines/landmark_map/refinement/broken_motion.h"
#include "pipelines/landmark_map/refinement/joint_covariances.h"
#include "pipelines/landmark_map/refinement/width_estimate.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {
namespace {

constexpr double kDegreeInRad = std::numbers::pi / 180.0;

// The rows of a robot's observations that are of a landmark.
struct SeenRow {
  double time_s, x_m, y_m;
  int landmark;
};

std::vector<SeenRow> RowsOfLandmarks(const kinds::Log::Observations& seen, const RowAssociations& associated,
                                     const Settings& settings, const std::vector<Landmark>& landmarks) {
  const auto time = seen.time_s.values(), range = seen.range_m.values(), bearing = seen.bearing_rad.values();
  const auto identity = seen.landmark.values();
  std::vector<SeenRow> rows;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (time[i] > settings.steps.until_s) break;
    int landmark = -1;
    if (identity[i] >= 0) {
      landmark = LandmarkNamed(landmarks, identity[i]);
    } else if (associated.probability[i] >= 0.5) {
      landmark = associated.landmark[i];
    }
    if (landmark < 0) continue;
    const bool contact = std::isnan(range[i]);
    rows.push_back({time[i], contact ? 0.0 : range[i] * std::cos(bearing[i]),
                    contact ? 0.0 : range[i] * std::sin(bearing[i]), landmark});
  }
  return rows;
}

// EM's poses at the nodes: odometry from the step before each, turned as that step is.
std::vector<Eigen::Vector3d> EmPath(const AssociatedPath& path, const Odometry& odometry,
                                    const NodeTrack& track) {
  const RobotSteps& steps = path.steps;  // without the drift
  std::vector<Eigen::Vector3d> nodes;
  for (const double time_s : track.time_s) {
    const auto after = std::ranges::upper_bound(steps.time_s, time_s) - steps.time_s.begin();
    const auto s = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after, 1) - 1);
    const OdometricPose step = PoseAt(odometry, steps.time_s[s]), at = PoseAt(odometry, time_s);
    const double heading = steps.odo_heading_rad[s] + path.correction_rad[s];
    const double turn = heading - step.heading_rad;
    const double dx = at.x_m - step.x_m, dy = at.y_m - step.y_m;
    Eigen::Vector3d node(path.x_m[s] + std::cos(turn) * dx - std::sin(turn) * dy,
                         path.y_m[s] + std::sin(turn) * dx + std::cos(turn) * dy,
                         heading + at.heading_rad - step.heading_rad);
    if (!nodes.empty()) {
      const double said = at.heading_rad - PoseAt(odometry, track.time_s[nodes.size() - 1]).heading_rad;
      const double turned = node[2] - nodes.back()[2];
      node[2] = nodes.back()[2] + said + std::remainder(turned - said, 2.0 * std::numbers::pi);
    }
    nodes.push_back(node);
  }
  return nodes;
}

// From odometry alone, half as much of the data again at a time: each part is settled before the next is
// reckoned from where it ends. `first`: the first pose of each robot.
LeastSquaresPoint TakenUpByOdometry(const LeastSquaresProblem& problem, const LeastSquaresPoint& first) {
  constexpr std::size_t kFirst = 20;
  LeastSquaresPoint point;
  for (const auto& nodes : first.nodes) point.nodes.push_back({nodes.front()});
  point.landmarks = first.landmarks;
  point.errors.resize(problem.robots.size());
  std::vector<bool> placed(point.landmarks.size(), false);
  for (std::size_t count = kFirst;; count += count / 2) {
    const bool all = count >= problem.sightings.size();
    const LeastSquaresProblem part = Beginning(problem, count);
    for (std::size_t r = 0; r < part.robots.size(); ++r) {
      auto& nodes = point.nodes[r];
      NodeTrack rest;
      rest.controls.assign(part.robots[r].controls.begin() + static_cast<std::ptrdiff_t>(nodes.size() - 1),
                           part.robots[r].controls.end());
      const auto on = DeadReckoned(rest, nodes.back(), point.errors[r]);
      nodes.insert(nodes.end(), on.begin() + 1, on.end());
    }
    for (const Sighting& seen : part.sightings) {
      const auto landmark = static_cast<std::size_t>(seen.landmark);
      if (placed[landmark]) continue;
      placed[landmark] = true;
      point.landmarks[landmark] = PlaceSeen(
          point.nodes[static_cast<std::size_t>(seen.robot)][static_cast<std::size_t>(seen.node)], seen);
    }
    point = Descend(part, point, all ? 0 : 30, kNearTheLeast).point;
    if (all) return point;
  }
}

// What a point costs under which another start is tried: none of a small problem, for there it takes no time;
// of a large one half a nat a residual, as right widths give it.
constexpr std::size_t kFewSightings = 2000;
double LeastOfManyTried(const LeastSquaresProblem& problem) {
  const std::size_t sightings = problem.sightings.size();
  return sightings < kFewSightings ? 0.0 : static_cast<double>(sightings);
}

// The least squares, the widths that are expected of it, EM's point in it, and each robot's odometry.
struct Built {
  LeastSquaresProblem problem;
  ExpectedWidths expected;
  LeastSquaresPoint em;
  std::vector<Odometry> odometry;
};

double WayPrior(const Settings& settings) { return std::max(settings.noise.forward_ratio, 0.02); }

Built Build(const kinds::Log& log, const std::vector<AssociatedPath>& paths,
            const std::vector<RowAssociations>& associated, const Settings& settings,
            const std::vector<Landmark>& landmarks) {
  Built built;
  const std::vector<std::string>& robots = log.robots;
  bool ranged = false;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const kinds::Log::Robot& robot = log.robot[r];
    built.odometry.push_back(Until(Integrate(robot.odometry, robots[r]), settings.steps.until_s));
    const std::vector<SeenRow> rows = RowsOfLandmarks(robot.observations, associated[r], settings, landmarks);
    std::vector<double> times;
    for (const SeenRow& row : rows) times.push_back(row.time_s);
    std::vector<int> node_of;
    built.problem.robots.push_back(TrackThrough(built.odometry[r], times, &node_of));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      built.problem.sightings.push_back(
          {static_cast<int>(r), node_of[i], rows[i].landmark, rows[i].x_m, rows[i].y_m});
      ranged |= !built.problem.sightings.back().contact();
    }
    const OdometryFit& fit = paths[r].odometry;
    built.problem.widths.push_back(
        {fit.heading_walk_rad_per_sqrt_m, fit.turn_ratio, settings.noise.forward_ratio});
    built.expected.odometry.push_back(
        {settings.expected_walk_rad_per_sqrt_m, settings.expected_turn_ratio, settings.noise.forward_ratio});
    built.em.nodes.push_back(EmPath(paths[r], built.odometry[r], built.problem.robots[r]));
    built.em.errors.push_back({.drift_rad_per_m = fit.drift_rad_per_m});
  }
  if (!settings.gauge_free) built.em.nodes[0][0].setZero();
  built.problem.landmarks = static_cast<int>(landmarks.size());
  built.problem.named = std::ranges::all_of(
      landmarks, [&](const Landmark& landmark) { return landmark.type < settings.map.types; });
  for (const Landmark& landmark : landmarks) built.em.landmarks.emplace_back(landmark.x_m, landmark.y_m);
  built.problem.noise = built.expected.sightings = settings.observation_noise;
  // Of turns narrow, but with the same heavy tails: over a few bends a scale of turns is hard to tell from a
  // drift.
  constexpr double kTurns = 0.005;
  // Wide, for a data sheet may be wrong by a factor; the scale of a way no contact detection tells.
  const double least_drift = (log.noise.heading_drift_rad_per_m ? 0.1 : 1.0) * kDegreeInRad;
  built.problem.priors = {std::max(settings.noise.heading_drift_rad_per_m, least_drift),
                          ranged ? WayPrior(settings) : 0.0, std::min(settings.noise.turn_ratio, kTurns)};
  return built;
}

// Whether errors are wider than was said or expected, or a motion stands out: else none is broken. Of many
// observations one broken motion makes no width wider, and stands out where it is.
bool IsInDoubt(const LeastSquaresProblem& nominal, const LeastSquaresProblem& problem,
               const LeastSquaresEnd& end) {
  if (problem.sightings.size() >= kFewSightings) return false;
  constexpr double kWider = 1.5;
  if (problem.noise.range_m > kWider * nominal.noise.range_m ||
      problem.noise.bearing_rad > kWider * nominal.noise.bearing_rad)
    return true;
  for (std::size_t r = 0; r < problem.widths.size(); ++r)
    if (problem.widths[r].walk_rad_per_sqrt_m > kWider * nominal.widths[r].walk_rad_per_sqrt_m ||
        problem.widths[r].turn_rad_per_sqrt_rad > kWider * nominal.widths[r].turn_rad_per_sqrt_rad ||
        problem.widths[r].way_m_per_sqrt_m > kWider * nominal.widths[r].way_m_per_sqrt_m)
      return true;
  for (const std::vector<double>& sigmas : EdgeSigmas(problem, end.point))
    if (std::ranges::any_of(sigmas, [](double sigma) { return sigma >= kJumpSigmas; })) return true;
  return false;
}

// The motions during which nothing was seen for longest, so many: there a robot has most time to be carried.
std::vector<BrokenMotion> LongestMotions(const LeastSquaresProblem& problem, std::size_t most) {
  std::vector<std::pair<double, BrokenMotion>> motions;
  for (std::size_t r = 0; r < problem.robots.size(); ++r) {
    const NodeTrack& track = problem.robots[r];
    for (std::size_t k = 0; k < track.controls.size(); ++k)
      if (!track.IsBroken(k)) motions.push_back({track.time_s[k + 1] - track.time_s[k], {r, k}});
  }
  std::ranges::stable_sort(motions, std::ranges::greater(), &std::pair<double, BrokenMotion>::first);
  motions.resize(std::min(motions.size(), most));
  std::vector<BrokenMotion> longest;
  for (const auto& [length_s, motion] : motions) longest.push_back(motion);
  return longest;
}

// Whether a landmark stands a metre elsewhere.
bool IsAnotherMap(const LeastSquaresPoint& one, const LeastSquaresPoint& other) {
  constexpr double kOther_m = 1.0;
  for (std::size_t l = 0; l < one.landmarks.size(); ++l)
    if ((one.landmarks[l] - other.landmarks[l]).norm() > kOther_m) return true;
  return false;
}

// The least with one more motion left free, of several the one that gives it: those without which the cost
// falls most, and the longest, for where a path is bent the former need not be it. None promises enough:
// nothing.
struct Freed {
  LeastSquaresProblem problem;
  LeastSquaresEnd end;
  std::optional<double> lead_nats = {};  // over the least without another motion, whose map is another one
};
std::optional<Freed> WithoutOneMotion(const LeastSquaresProblem& nominal, const LeastSquaresPoint& point) {
  constexpr std::size_t kMostGain = 4, kLongest = 3;
  constexpr int kSteps = 15;
  constexpr double kLook_nats = 15.0;
  std::vector<BrokenMotion> motions = FindBrokenMotions(nominal, point, kMostGain);
  std::erase_if(motions, [](const BrokenMotion& motion) { return motion.gain_nats < kLook_nats; });
  if (motions.empty()) return std::nullopt;
  for (const BrokenMotion& longest : LongestMotions(nominal, kLongest)) motions.push_back(longest);
  std::vector<Freed> freed;
  for (const BrokenMotion& motion : motions) {
    LeastSquaresProblem without = nominal;
    without.robots[motion.robot].broken.push_back(motion.edge);
    // From where it is bent the way may be barred.
    for (const LeastSquaresPoint& start : {point, TakenUpByOdometry(without, point)}) {
      freed.push_back({without, Descend(without, start, kSteps, kNearTheLeast)});
    }
  }
  std::ranges::stable_sort(freed, {}, [](const Freed& one) { return one.end.cost; });
  for (const Freed& other : freed)
    if (!freed[0].lead_nats && IsAnotherMap(freed[0].end.point, other.end.point))
      freed[0].lead_nats = other.end.cost - freed[0].end.cost;
  return std::move(freed[0]);
}

// A motion that odometry knows nothing of bends the whole path, and where widths are estimated they take it
// up. Where one more such motion explains so much more that it is believed, it is left free, and all is
// settled anew.
std::optional<double> FreeBrokenMotions(const ExpectedWidths& expected, LeastSquaresProblem* nominal,
                                        LeastSquaresProblem* problem, LeastSquaresEnd* end) {
  std::optional<double> lead_nats;
  constexpr int kMost = 5;
  constexpr double kBelieved_nats = 10.0;
  for (int k = 0; k < kMost && IsInDoubt(*nominal, *problem, *end); ++k) {
    auto tried = WithoutOneMotion(*nominal, end->point);
    if (!tried) break;
    LeastSquaresProblem settled = tried->problem;
    if (!SettleWidths(expected, &settled, &tried->end)) break;
    if (NegativeLogDensity(*problem, end->point) - NegativeLogDensity(settled, tried->end.point) <
        kBelieved_nats)
      break;
    *nominal = std::move(tried->problem);
    *problem = std::move(settled);
    *end = std::move(tried->end);
    if (tried->lead_nats) lead_nats = std::min(*tried->lead_nats, lead_nats.value_or(*tried->lead_nats));
  }
  return lead_nats;
}

// A sensor's zero is seldom better than what single ranges err by.
double OffsetPrior_m(const LeastSquaresProblem& problem) { return problem.noise.range_m; }

// Whether ranges that are too long or too short by a constant explain so much more that each would err by 7%
// less. Ranges that are distorted otherwise a constant fits a little, too, and makes no better map of them.
bool HasOffset(const LeastSquaresProblem& problem, const LeastSquaresEnd& end) {
  constexpr int kSteps = 20;
  constexpr double kGain = 0.0677;  // nats a range: log(1.07)
  const auto ranges = problem.sightings.size() -
                      static_cast<std::size_t>(std::ranges::count_if(problem.sightings, &Sighting::contact));
  if (ranges == 0) return false;
  LeastSquaresProblem tried = problem;
  tried.repeats = {};  // an offset that nobody takes off makes errors that go on
  const LeastSquaresEnd without = Descend(tried, end.point, kSteps, kNearTheLeast);
  tried.priors.range_m = OffsetPrior_m(problem);
  const LeastSquaresEnd with = Descend(tried, without.point, kSteps, kNearTheLeast);
  return without.cost - with.cost > kGain * static_cast<double>(ranges);
}

// A landmark of which the least squares knows nothing.
void StandsAlone(std::size_t l, const Landmark& landmark, Eigen::MatrixXd* covariance) {
  if (covariance->size() == 0) return;
  const auto at = 2 * static_cast<Eigen::Index>(l);
  covariance->middleRows<2>(at).setZero();
  covariance->middleCols<2>(at).setZero();
  for (int k = 0; k < 4; ++k) (*covariance)(at + k / 2, at + k % 2) = landmark.covariance_m2[k];
}

}  // namespace

JointRefinement RefineJointly(const kinds::Log& log, const std::vector<AssociatedPath>& paths,
                              const std::vector<RowAssociations>& rows, const Settings& settings,
                              const std::vector<Landmark>& landmarks) {
  Built built = Build(log, paths, rows, settings, landmarks);
  if (built.problem.sightings.empty()) return {"no observation is of a landmark", landmarks, {}, {}, {}};
  const double em_cost = CostOf(built.problem, built.em);
  constexpr int kMostSteps = 50;
  LeastSquaresEnd end = Descend(built.problem, built.em, kMostSteps, kNearTheLeast);
  if (end.cost > LeastOfManyTried(built.problem)) {
    const LeastSquaresEnd other =
        Descend(built.problem, TakenUpByOdometry(built.problem, built.em), kMostSteps, kNearTheLeast);
    if (other.cost < end.cost) end = other;
  }
  if (!(end.cost <= em_cost))
    return {"the least squares explains less than EM's own path", landmarks, {}, {}, {}};

  LeastSquaresProblem problem = built.problem;
  bool solved = SettleWidths(built.expected, &problem, &end);
  const std::optional<double> break_lead_nats =
      solved ? FreeBrokenMotions(built.expected, &built.problem, &problem, &end) : std::nullopt;
  if (solved && HasOffset(problem, end)) {
    problem.priors.range_m = OffsetPrior_m(problem);
    solved = SettleWidths(built.expected, &problem, &end);
  }
  if (!solved) return {"the least squares has no solution", landmarks, {}, {}, {}};
  constexpr double kMostScale = 0.5;
  for (const SystematicErrors& errors : end.point.errors) {
    if (!(std::max(std::abs(errors.way), std::abs(errors.turn)) < kMostScale))
      return {kinds::kOdometryWrongByHalf, landmarks, {}, {}, {}};
  }
  // The scale that contact detections do not tell is uncertain all the same, and with it all places.
  LeastSquaresProblem considered = problem;
  // At its middle a Cauchy prior is as narrow as a Gaussian of 1 / sqrt(2) its scale.
  if (!(problem.priors.way > 0.0)) considered.priors.way = std::numbers::sqrt2 * WayPrior(settings);
  const LeastSquaresCovariances covariances = CovariancesOf(considered, end.point);
  if (covariances.landmarks.empty()) return {"the least squares has no solution", landmarks, {}, {}, {}};
  JointRefinement refined{"",
                          landmarks,
                          {},
                          FitOf(built.problem, problem, end.point),
                          FindSensorShifts(problem, end.point, built.odometry, built.expected.odometry),
                          problem,
                          end.point};
  refined.covariance = covariances.joint;
  refined.fit.break_lead_nats = break_lead_nats;
  std::vector<bool> seen(landmarks.size(), false);
  for (const Sighting& sighting : problem.sightings) seen[static_cast<std::size_t>(sighting.landmark)] = true;
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    Landmark& landmark = refined.landmarks[l];
    if (!seen[l]) {
      StandsAlone(l, landmark, &refined.covariance);
      continue;
    }
    landmark.x_m = end.point.landmarks[l].x();
    landmark.y_m = end.point.landmarks[l].y();
    for (int k = 0; k < 4; ++k) landmark.covariance_m2[k] = covariances.landmarks[l](k / 2, k % 2);
  }
  for (std::size_t r = 0; r < paths.size(); ++r) {
    refined.paths.emplace_back(built.odometry[r], problem.robots[r], end.point.nodes[r], covariances.nodes[r],
                               end.point.errors[r], problem.widths[r]);
  }
  return refined;
}

}  // namespace cairn::landmark_map
