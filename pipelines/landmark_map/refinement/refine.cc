#include "pipelines/landmark_map/refinement/refine.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "pipelines/common/handed_over.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

constexpr int kIterations = 20;
constexpr double kCauchy = 3.0;      // standard deviations at which an observation weighs half
constexpr double kLeastSd_m = 0.02;  // no wheel is better, nor is a turn on the spot one
constexpr double kLeastTurn_rad = 1e-3;
// The distance errs by the nominal ratio anew every so often. What is constant in it is the map's scale,
// which data cannot show: left free it shrinks the map.
constexpr double kOwnError_m = 1.0;
constexpr double kFixed = 1e-6, kFree = 1e4;  // standard deviations of the first pose, of any unknown

std::string Text(const char* format, double a, double b) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// The circular means of a path, each within half a turn of the one before: their differences are what the
// heading did from step to step, on either side of pi too.
std::vector<double> Unwrapped(std::vector<double> angles_rad) {
  for (std::size_t k = 1; k < angles_rad.size(); ++k) {
    const double before = angles_rad[k - 1];
    angles_rad[k] = before + std::remainder(angles_rad[k] - before, 2.0 * std::numbers::pi);
  }
  return angles_rad;
}

// Normal equations of weighted residuals, each linear in a few of the unknowns.
class NormalEquations {
 public:
  explicit NormalEquations(int unknowns) : gradient_(Eigen::VectorXd::Zero(unknowns)) {
    for (int k = 0; k < unknowns; ++k) entries_.emplace_back(k, k, 1.0 / Square(kFree));
  }

  // `jacobian`: (unknown, derivative of the residual).
  void Add(double residual, double sd, std::initializer_list<std::pair<int, double>> jacobian) {
    const double weight = 1.0 / Square(sd);
    squares_ += weight * Square(residual);
    for (const auto& [a, derivative_a] : jacobian) {
      gradient_[a] += weight * derivative_a * residual;
      for (const auto& [b, derivative_b] : jacobian)
        entries_.emplace_back(a, b, weight * derivative_a * derivative_b);
    }
  }

  // False where they have no solution.
  bool Factorise() {
    Eigen::SparseMatrix<double> matrix(gradient_.size(), gradient_.size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    solver_.compute(matrix);
    return solver_.info() == Eigen::Success;
  }
  double squares() const { return squares_; }  // of the residuals, weighted
  Eigen::VectorXd Step() const { return -solver_.solve(gradient_); }
  Eigen::VectorXd Column(int unknown) const {
    return solver_.solve(Eigen::VectorXd::Unit(gradient_.size(), unknown));
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd gradient_;
  double squares_ = 0.0;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

// All unknowns in one vector: poses of all robots (x, y, correction unwrapped along the path), landmarks (x,
// y), drifts left over.
class Problem {
 public:
  Problem(const std::vector<AssociatedPath>& paths, const Settings& settings,
          const std::vector<Landmark>& landmarks)
      : paths_(paths), settings_(settings) {
    int size = 0;
    for (const AssociatedPath& path : paths) {
      first_pose_.push_back(size);
      size += 3 * path.steps.size();
    }
    first_landmark_ = size;
    first_drift_ = size + 2 * static_cast<int>(landmarks.size());
    values_ = Eigen::VectorXd::Zero(first_drift_ + static_cast<int>(paths.size()));
    for (std::size_t r = 0; r < paths.size(); ++r) {
      const std::vector<double> correction_rad = Unwrapped(paths[r].correction_rad);
      for (int s = 0; s < paths[r].steps.size(); ++s) {
        const auto k = static_cast<std::size_t>(s);
        values_.segment<3>(PoseAt(r, s)) << paths[r].x_m[k], paths[r].y_m[k], correction_rad[k];
      }
    }
    if (settings.gauge_free) first_ = values_.head<3>();
    for (std::size_t l = 0; l < landmarks.size(); ++l) {
      types_.push_back(landmarks[l].type);
      values_.segment<2>(LandmarkAt(l)) << landmarks[l].x_m, landmarks[l].y_m;
    }
  }

  // Empty, or why there is nothing better.
  std::string Solve() {
    const double squares_before = Squares();
    const std::vector<bool> nearest_before = NearestToTheirs();
    if (!Descend()) return "the least squares has no solution";
    const double squares = Squares();
    if (!(squares <= squares_before))
      return Text("the weighted squares of its residuals rose from %.1f to %.1f", squares_before, squares);
    const std::vector<bool> nearest = NearestToTheirs();
    int left = 0;
    for (std::size_t k = 0; k < nearest.size(); ++k) left += nearest_before[k] && !nearest[k] ? 1 : 0;
    if (left == 0) return {};
    return Text("%.0f of %.0f observations would then lie nearer to another landmark than to their own", left,
                static_cast<double>(nearest.size()));
  }
  std::vector<Landmark> Landmarks(std::vector<Landmark> landmarks) const {
    NormalEquations equations(unknowns());
    Linearise(&equations);
    if (!equations.Factorise()) return landmarks;
    const std::vector<bool> seen = Seen(landmarks.size());
    for (std::size_t l = 0; l < landmarks.size(); ++l) {
      if (!seen[l]) continue;
      const int at = LandmarkAt(l);
      landmarks[l].x_m = values_[at];
      landmarks[l].y_m = values_[at + 1];
      for (int k = 0; k < 2; ++k) {
        const Eigen::VectorXd column = equations.Column(at + k);
        landmarks[l].covariance_m2[k] = column[at];
        landmarks[l].covariance_m2[2 + k] = column[at + 1];
      }
    }
    return landmarks;
  }

 private:
  int unknowns() const { return static_cast<int>(values_.size()); }
  int PoseAt(std::size_t robot, int step) const { return first_pose_[robot] + 3 * step; }
  int LandmarkAt(std::size_t landmark) const { return first_landmark_ + 2 * static_cast<int>(landmark); }

  bool Descend() {
    for (int i = 0; i < kIterations; ++i) {
      NormalEquations equations(unknowns());
      Linearise(&equations);
      if (!equations.Factorise()) return false;
      const Eigen::VectorXd step = equations.Step();
      if (!step.allFinite()) return false;
      values_ += step;
      if (step.lpNorm<Eigen::Infinity>() < 1e-6) break;
    }
    return true;
  }

  double Squares() const {
    NormalEquations equations(unknowns());
    Linearise(&equations);
    return equations.squares();
  }

  // Of each observation that is of a landmark: is none of its type nearer?
  std::vector<bool> NearestToTheirs() const {
    std::vector<bool> nearest;
    for (std::size_t r = 0; r < paths_.size(); ++r) {
      const RobotSteps& steps = paths_[r].steps;
      for (int s = 0; s < steps.size(); ++s) {
        for (int k = steps.first_observation[s]; k < steps.first_observation[s + 1]; ++k) {
          const auto at = static_cast<std::size_t>(k);
          if (!IsOfLandmark(paths_[r].associated, at)) continue;
          const auto own = static_cast<std::size_t>(paths_[r].associated.landmark[at]);
          nearest.push_back(IsNearest(own, PlaceOf(PoseAt(r, s), steps.observations[at])));
        }
      }
    }
    return nearest;
  }
  // Where the observation says that its landmark stands.
  Eigen::Vector2d PlaceOf(int pose, const Observation& seen) const {
    const Eigen::Rotation2Dd turn(values_[pose + 2]);
    return values_.segment<2>(pose) + turn * Eigen::Vector2d(seen.x_m, seen.y_m);
  }
  bool IsNearest(std::size_t landmark, const Eigen::Vector2d& place) const {
    const auto distance = [&](std::size_t l) { return (place - values_.segment<2>(LandmarkAt(l))).norm(); };
    const double own = distance(landmark);
    for (std::size_t l = 0; l < types_.size(); ++l) {
      if (types_[l] == types_[landmark] && distance(l) < own) return false;
    }
    return true;
  }

  static bool IsOfLandmark(const Associated& of, std::size_t observation) {
    return of.landmark[observation] >= 0 && of.probability[observation] >= 0.5;
  }
  std::vector<bool> Seen(std::size_t landmarks) const {
    std::vector<bool> seen(landmarks, false);
    for (const AssociatedPath& path : paths_) {
      for (std::size_t k = 0; k < path.associated.landmark.size(); ++k) {
        if (IsOfLandmark(path.associated, k))
          seen[static_cast<std::size_t>(path.associated.landmark[k])] = true;
      }
    }
    return seen;
  }

  void Linearise(NormalEquations* to) const {
    NormalEquations& equations = *to;
    for (int k = 0; k < 3; ++k) equations.Add(values_[k] - first_[k], kFixed, {{k, 1.0}});
    for (std::size_t r = 0; r < paths_.size(); ++r) {
      for (int s = 1; s < paths_[r].steps.size(); ++s) AddIncrement(r, s, &equations);
      for (int s = 0; s < paths_[r].steps.size(); ++s) AddObservations(r, s, &equations);
      const int drift = first_drift_ + static_cast<int>(r);
      const double sd = std::max(1e-9, settings_.noise.heading_drift_rad_per_m);
      equations.Add(paths_[r].odometry.drift_rad_per_m + values_[drift], sd, {{drift, 1.0}});
    }
  }

  // Half of the heading's error lies before the way, half after it (common/motion.h): given the heading at
  // both ends, the way's direction is their mean's, to within half of the error.
  void AddIncrement(std::size_t robot, int step, NormalEquations* equations) const {
    const AssociatedPath& path = paths_[robot];
    const MotionIncrement increment = path.steps.IncrementTo(step);
    MotionNoise noise = path.odometry.Widths(settings_.noise);
    noise.heading_drift_rad_per_m = 0.0;  // an unknown of its own
    const IncrementError error = ErrorOf(increment, noise);
    const double turn_sd = std::max(kLeastTurn_rad, error.heading_rad);
    const int a = PoseAt(robot, step - 1), b = PoseAt(robot, step);
    const int drift = first_drift_ + static_cast<int>(robot);
    equations->Add(values_[b + 2] - values_[a + 2] + values_[drift] * increment.path_m, turn_sd,
                   {{a + 2, -1.0}, {b + 2, 1.0}, {drift, increment.path_m}});
    const double middle = 0.5 * (values_[a + 2] + values_[b + 2]);
    const double cosine = std::cos(middle), sine = std::sin(middle);
    const double x = cosine * increment.dx_m - sine * increment.dy_m,
                 y = sine * increment.dx_m + cosine * increment.dy_m;
    const double length = std::hypot(x, y);
    const double ux = length > 0 ? x / length : 1.0, uy = length > 0 ? y / length : 0.0;
    const double dx = values_[b] - values_[a] - x, dy = values_[b + 1] - values_[a + 1] - y;
    const double along_sd =
        std::max(kLeastSd_m, settings_.noise.forward_ratio * std::sqrt(increment.path_m * kOwnError_m));
    const double across_sd = std::max(kLeastSd_m, 0.5 * length * turn_sd);
    equations->Add(ux * dx + uy * dy, along_sd, {{a, -ux}, {a + 1, -uy}, {b, ux}, {b + 1, uy}});
    equations->Add(
        ux * dy - uy * dx, across_sd,
        {{a, uy}, {a + 1, -ux}, {b, -uy}, {b + 1, ux}, {a + 2, -0.5 * length}, {b + 2, -0.5 * length}});
  }

  void AddObservations(std::size_t robot, int step, NormalEquations* equations) const {
    const AssociatedPath& path = paths_[robot];
    const int pose = PoseAt(robot, step);
    for (int k = path.steps.first_observation[step]; k < path.steps.first_observation[step + 1]; ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (!IsOfLandmark(path.associated, at)) continue;
      const int landmark = LandmarkAt(static_cast<std::size_t>(path.associated.landmark[at]));
      AddObservation(pose, landmark, path.steps.observations[at], equations);
    }
  }

  // Its errors along the ray and across it, which turn with the robot: their derivatives have what that does,
  // or the map would creep round. A contact detection has no ray.
  void AddObservation(int pose, int landmark, const Observation& seen, NormalEquations* equations) const {
    const Eigen::Vector2d place = PlaceOf(pose, seen), offset = place - values_.segment<2>(pose);
    const double range = offset.norm();
    const bool contact = seen.contact();
    const double ux = contact ? 1.0 : offset.x() / range, uy = contact ? 0.0 : offset.y() / range;
    const Eigen::Vector2d error = place - values_.segment<2>(landmark);
    const double along = ux * error.x() + uy * error.y(), across = ux * error.y() - uy * error.x();
    const ObservationWidths sd = settings_.observation_noise.At(seen.x_m, seen.y_m);
    const double cauchy =
        std::sqrt(1.0 + (Square(along / sd.along_m) + Square(across / sd.across_m)) / Square(kCauchy));
    const double along_rad = contact ? 0.0 : across, across_rad = contact ? 0.0 : range - along;
    equations->Add(along, cauchy * sd.along_m,
                   {{pose, ux}, {pose + 1, uy}, {pose + 2, along_rad}, {landmark, -ux}, {landmark + 1, -uy}});
    equations->Add(
        across, cauchy * sd.across_m,
        {{pose, -uy}, {pose + 1, ux}, {pose + 2, across_rad}, {landmark, uy}, {landmark + 1, -ux}});
  }

  const std::vector<AssociatedPath>& paths_;
  const Settings& settings_;
  std::vector<int> first_pose_;
  std::vector<int> types_;  // of the landmarks
  int first_landmark_ = 0, first_drift_ = 0;
  Eigen::VectorXd values_;
  Eigen::Vector3d first_ = Eigen::Vector3d::Zero();  // where the first robot's first pose stays
};

bool SeesAtADistance(const AssociatedPath& path) {
  return std::ranges::any_of(path.steps.observations,
                             [](const Observation& seen) { return !seen.contact(); });
}

double FarthestMove(const std::vector<Landmark>& before, const std::vector<Landmark>& now) {
  double farthest_m = 0.0;
  for (std::size_t l = 0; l < now.size(); ++l)
    farthest_m = std::max(farthest_m, std::hypot(now[l].x_m - before[l].x_m, now[l].y_m - before[l].y_m));
  return farthest_m;
}

// By its own covariance.
double Width(const Landmark& landmark) {
  return std::sqrt(std::max(0.0, 0.5 * (landmark.covariance_m2[0] + landmark.covariance_m2[3])));
}

// A Gaussian of that mass around the landmark.
void SpreadMass(const Landmark& landmark, double sd_m, double mass, const Settings& settings, Layer* layer) {
  constexpr double kLeastSd = 0.5, kReach = 3.0;  // cells: narrower ones lose their mean; standard deviations
  constexpr double kMostReach = 1 << 20, kFarthest = 1 << 26;  // cells
  const double cell_m = settings.map.grid.cell_m, sd = std::max(kLeastSd, sd_m / cell_m);
  const double x0 = landmark.x_m / cell_m, y0 = landmark.y_m / cell_m;
  RequireWithin("the width of a landmark in cells", kReach * sd, 0.0, kMostReach);
  for (const double at : {x0, y0}) RequireWithin("a landmark's place in cells", at, -kFarthest, kFarthest);
  const int reach = static_cast<int>(std::ceil(kReach * sd));
  const Box box =
      Box{static_cast<int>(std::lround(x0)), static_cast<int>(std::lround(y0)), 1, 1}.Grown(reach);
  const Box wide = Union(layer->box, box);
  RequireMemory("a landmark", sizeof(double) * static_cast<double>(box.cells() + wide.cells()),
                settings.memory_mb);
  Layer bump(box);
  for (int y = box.y0; y < box.y0 + box.ny; ++y) {
    for (int x = box.x0; x < box.x0 + box.nx; ++x)
      bump.Row(y)[x] = std::exp(-0.5 * (Square(x - x0) + Square(y - y0)) / Square(sd));
  }
  layer->Cover(box);
  layer->AddShifted(bump, 0, 0, mass / bump.Sum());
}

}  // namespace

std::vector<AssociatedPath> AssociatedPaths(const RoundSum& sum, const std::vector<RobotSteps>& steps,
                                            const std::vector<OdometryFit>& odometry, std::size_t landmarks) {
  std::vector<AssociatedPath> paths;
  for (std::size_t r = 0; r < steps.size(); ++r) {
    const std::vector<Blob> summaries = sum.SummariesOf(r);
    CheckSummaries(summaries, steps[r], landmarks);
    paths.push_back({steps[r].WithoutDrift(odometry[r].drift_rad_per_m), odometry[r],
                     Joined(summaries, "pose/x_m"), Joined(summaries, "pose/y_m"),
                     Joined(summaries, "pose/heading_rad"), AssociatedIn(summaries)});
  }
  return paths;
}

Refinement RefineMap(const std::vector<AssociatedPath>& paths, const Settings& settings,
                     const std::vector<Landmark>& landmarks) {
  Problem problem(paths, settings, landmarks);
  if (std::string why = problem.Solve(); !why.empty()) return {{}, std::move(why)};
  Refinement refined{problem.Landmarks(landmarks), {}};
  const double moved_m = FarthestMove(landmarks, refined.landmarks), core_m = settings.map.core_m;
  if (std::ranges::any_of(paths, SeesAtADistance) && moved_m > core_m)
    refined.refused =
        Text("a landmark seen at a distance would move by %.2f m, further than %.2f m", moved_m, core_m);
  return refined;
}

namespace {

// Where a landmark counts.
Layer& LayerOf(const Landmark& landmark, const MapRules& rules, LayeredGrid* counts) {
  const int layer = landmark.type < rules.types ? landmark.type : rules.types + landmark.landmark_class;
  return counts->layers[static_cast<std::size_t>(layer)];
}

}  // namespace

LayeredGrid CountsFromLandmarks(const std::vector<Landmark>& landmarks, const Settings& settings) {
  LayeredGrid counts = NoCounts(settings.map);
  for (const Landmark& landmark : landmarks)
    SpreadMass(landmark, Width(landmark), landmark.count, settings,
               &LayerOf(landmark, settings.map, &counts));
  return counts;
}

LayeredGrid Recentred(LayeredGrid counts, const std::vector<Landmark>& before,
                      const std::vector<Landmark>& now, const Settings& settings,
                      std::optional<double> width_m) {
  std::vector<std::vector<double>> masses;
  for (const Landmark& landmark : before) masses.push_back(LeaveOut(landmark, settings.map, &counts));
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double width = width_m.value_or(Width(now[k]));
    for (std::size_t l = 0; l < counts.layers.size(); ++l)
      if (masses[k][l] > 0.0) SpreadMass(now[k], width, masses[k][l], settings, &counts.layers[l]);
    if (std::ranges::all_of(masses[k], [](double mass) { return mass == 0.0; }))
      SpreadMass(now[k], width, now[k].count, settings, &LayerOf(now[k], settings.map, &counts));
  }
  return counts;
}

}  // namespace cairn::landmark_map
