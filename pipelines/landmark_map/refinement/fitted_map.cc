#include "pipelines/landmark_map/refinement/fitted_map.h"

#include <algorithm>

namespace cairn::landmark_map {
namespace {

LeastSquaresProblem WithWiderOf(LeastSquaresProblem problem, const LeastSquaresProblem& other) {
  const auto widen = [](double* width, double than) { *width = std::max(*width, than); };
  for (std::size_t r = 0; r < problem.widths.size(); ++r) {
    widen(&problem.widths[r].walk_rad_per_sqrt_m, other.widths[r].walk_rad_per_sqrt_m);
    widen(&problem.widths[r].turn_rad_per_sqrt_rad, other.widths[r].turn_rad_per_sqrt_rad);
    widen(&problem.widths[r].way_m_per_sqrt_m, other.widths[r].way_m_per_sqrt_m);
  }
  widen(&problem.noise.range_m, other.noise.range_m);
  widen(&problem.noise.bearing_rad, other.noise.bearing_rad);
  problem.tail_sigmas = std::min(problem.tail_sigmas, other.tail_sigmas);
  widen(&problem.repeats.along, other.repeats.along);
  widen(&problem.repeats.across, other.repeats.across);
  return problem;
}

}  // namespace

std::int64_t RowsOfNone(const std::vector<RowAssociations>& rows) {
  std::int64_t none = 0;
  for (const RowAssociations& robot : rows) none += std::ranges::count(robot.landmark, -1);
  return none;
}

double CostBeside(const JointRefinement& map, const JointRefinement& other) {
  return Descend(WithWiderOf(map.problem, other.problem), map.point).cost;
}

}  // namespace cairn::landmark_map
