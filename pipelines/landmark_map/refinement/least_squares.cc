#include "pipelines/landmark_map/refinement/least_squares.h"

#include <algorithm>
#include <cmath>

#include "pipelines/landmark_map/refinement/joint_equations.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

constexpr double kLeastDecrease = 1e-3;  // nats that a step must promise

}  // namespace

LeastSquaresProblem Beginning(const LeastSquaresProblem& whole, std::size_t sightings) {
  if (sightings >= whole.sightings.size()) return whole;
  std::vector<double> times;
  for (const Sighting& seen : whole.sightings)
    times.push_back(
        whole.robots[static_cast<std::size_t>(seen.robot)].time_s[static_cast<std::size_t>(seen.node)]);
  std::ranges::sort(times);
  LeastSquaresProblem part = whole;
  for (NodeTrack& track : part.robots) {
    const auto nodes = std::max<std::ptrdiff_t>(
        1, std::ranges::upper_bound(track.time_s, times[sightings - 1]) - track.time_s.begin());
    track.time_s.resize(static_cast<std::size_t>(nodes));
    track.controls.resize(static_cast<std::size_t>(nodes - 1));
    std::erase_if(track.broken, [&](std::size_t edge) { return edge >= track.controls.size(); });
  }
  std::erase_if(part.sightings, [&](const Sighting& seen) {
    return static_cast<std::size_t>(seen.node) >=
           part.robots[static_cast<std::size_t>(seen.robot)].time_s.size();
  });
  return part;
}

Eigen::Vector2d PlaceSeen(const Eigen::Vector3d& node, const Sighting& seen, double offset_m) {
  const double cosine = std::cos(node[2]), sine = std::sin(node[2]);
  const double share = seen.contact() ? 1.0 : 1.0 - offset_m / std::hypot(seen.x_m, seen.y_m);
  const double x = share * seen.x_m, y = share * seen.y_m;
  return {node[0] + cosine * x - sine * y, node[1] + sine * x + cosine * y};
}

double LogTailNorm(double tail_sigmas) { return std::log1p(-2.0 / Square(tail_sigmas)); }

Eigen::Matrix3d CovarianceOf(const EdgeSpread& spread, const EdgeWidths& widths) {
  return Square(widths.walk_rad_per_sqrt_m) * spread.walk +
         Square(widths.turn_rad_per_sqrt_rad) * spread.turn + Square(widths.way_m_per_sqrt_m) * spread.way +
         spread.slip;
}

std::vector<Eigen::Vector3d> DeadReckoned(const NodeTrack& track, const Eigen::Vector3d& first,
                                          const SystematicErrors& errors) {
  std::vector<Eigen::Vector3d> nodes{first};
  for (const std::vector<Control>& controls : track.controls) {
    const Eigen::Vector3d motion = Integral(controls, errors).motion, &from = nodes.back();
    const double cosine = std::cos(from[2]), sine = std::sin(from[2]);
    nodes.emplace_back(from[0] + cosine * motion[0] - sine * motion[1],
                       from[1] + sine * motion[0] + cosine * motion[1], from[2] + motion[2]);
  }
  return nodes;
}

double CostOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  return JointEquations(problem, point).Evaluate(point, false);
}

// K. Madsen, H. Nielsen, O. Tingleff, Methods for non-linear least squares problems, 2004: algorithm 3.16
LeastSquaresEnd Descend(const LeastSquaresProblem& problem, const LeastSquaresPoint& start, int most_steps,
                        double share) {
  JointEquations equations(problem, start);
  LeastSquaresEnd end{start, equations.Evaluate(start, true)};
  double damping = 1e-6, growth = 2.0;
  while (end.steps < most_steps && !end.settled) {
    ++end.steps;
    if (!equations.Factorise(damping)) {
      damping *= growth;
      growth *= 2.0;
      continue;
    }
    const Eigen::VectorXd step = -equations.matrix().Solve(equations.gradient());
    double promised = 0.0;
    for (int k = 0; k < step.size(); ++k)
      promised += 0.5 * step[k] * (damping * equations.diagonal()[k] * step[k] - equations.gradient()[k]);
    const LeastSquaresPoint tried = equations.layout().Moved(end.point, step);
    const double cost = equations.Evaluate(tried, true);
    if (std::isfinite(cost) && cost < end.cost) {
      const double gain = (end.cost - cost) / promised;
      damping = std::max(1e-12, damping * std::max(1.0 / 9.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
      growth = 2.0;
      end.point = tried;
      end.cost = cost;
    } else {
      equations.Evaluate(end.point, true);
      damping *= growth;
      growth *= 2.0;
    }
    end.settled = promised < kLeastDecrease + share * end.cost;
  }
  return end;
}

std::vector<double> SightingSigmas(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  const JointEquations equations(problem, point);
  std::vector<double> sigmas;
  for (const Sighting& seen : problem.sightings)
    sigmas.push_back(equations.Seen(point, seen).residual.error.norm());
  return sigmas;
}

std::vector<std::vector<double>> EdgeSigmas(const LeastSquaresProblem& problem,
                                            const LeastSquaresPoint& point) {
  const JointEquations equations(problem, point);
  std::vector<std::vector<double>> sigmas(problem.robots.size());
  for (std::size_t r = 0; r < problem.robots.size(); ++r) {
    for (std::size_t k = 0; k < problem.robots[r].controls.size(); ++k) {
      const Eigen::Vector3d error = equations.Edge(point, r, k).error;
      sigmas[r].push_back(std::sqrt(std::max(0.0, error.dot(equations.Weight(r, k) * error))));
    }
  }
  return sigmas;
}

std::vector<std::vector<Eigen::Vector2d>> SightingErrors_m(const LeastSquaresProblem& problem,
                                                           const LeastSquaresPoint& point) {
  std::vector<std::vector<Eigen::Vector2d>> errors_m(point.landmarks.size());
  for (const Sighting& seen : problem.sightings) {
    const auto robot = static_cast<std::size_t>(seen.robot), node = static_cast<std::size_t>(seen.node),
               landmark = static_cast<std::size_t>(seen.landmark);
    errors_m[landmark].push_back(PlaceSeen(point.nodes[robot][node], seen, point.errors[robot].range_m) -
                                 point.landmarks[landmark]);
  }
  return errors_m;
}

}  // namespace cairn::landmark_map
