#include "pipelines/local_map/traces/correlation.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {
namespace {

// [DM98] section 4.2: matching whole occupancy grids, for comparison
double Correlation(const GridMap& map, const GridMap& now, int dz, int du) {
  double product = 0, map_square = 0, now_square = 0;
  for (int z = now.first_z(); z < now.end_z(); ++z)
    for (int u = -now.half_u(); u <= now.half_u(); ++u) {
      const float a = map.At(z + dz, u + du), b = now.At(z, u);
      product += a * b;
      map_square += a * a;
      now_square += b * b;
    }
  return map_square > 0 && now_square > 0 ? product / std::sqrt(map_square * now_square) : 0;
}

}  // namespace

GridMap::GridMap(double cell_m, int first_z, int size_z, int half_u)
    : cell_m_(cell_m),
      first_z_(first_z),
      size_z_(size_z),
      half_u_(half_u),
      cells_(static_cast<std::size_t>(size_z) * static_cast<std::size_t>(2 * half_u + 1)) {}

void GridMap::Add(const LocalGrids& grids, const TraceFrame& frame) {
  const OccupancyGrid& occupancy = grids.occupancy();
  const CellIndex centre = occupancy.centre();
  const Position robot = frame.At({centre.i * cell_m_, centre.j * cell_m_}, cell_m_);
  const auto at_z = static_cast<int>(std::lround(robot.z_m / cell_m_));
  const auto at_u = static_cast<int>(std::lround(robot.u_m / cell_m_));
  const int half = occupancy.half();
  for (int z = std::max(first_z_, at_z - half); z < std::min(end_z(), at_z + half + 1); ++z)
    for (int u = std::max(-half_u_, at_u - half); u <= std::min(half_u_, at_u + half); ++u) {
      const CellIndex cell = frame.CellAt(z, u);
      Cell& sum = cells_[IndexOf(z, u)];
      sum.seen += 1;
      sum.occupied += occupancy.Occupied(cell.i, cell.j) ? 1 : 0;
    }
}

GridMap MapOfNow(const LocalGrids& grids, int quarter) {
  const int half = grids.occupancy().half();
  GridMap map(grids.occupancy().cell_m(), -half, 2 * half + 1, half);
  map.Add(grids, {quarter, grids.occupancy().centre()});
  return map;
}

Position CorrelateGrids(const GridMap& map, const GridMap& now, const Position& robot, const Position& at,
                        const SearchWindow& range) {
  const double cell_m = map.cell_m();
  const auto z0 = static_cast<int>(std::lround((at.z_m - robot.z_m) / cell_m));
  const auto u0 = static_cast<int>(std::lround((at.u_m - robot.u_m) / cell_m));
  const auto reach_z = static_cast<int>(std::ceil(range.z_m / cell_m));
  const auto reach_u = static_cast<int>(std::ceil(range.u_m / cell_m));
  const auto value = [&](int dz, int du) { return Correlation(map, now, z0 + dz, u0 + du); };
  int best_z = 0, best_u = 0;
  double best = value(0, 0);
  for (int dz = -reach_z; dz <= reach_z; ++dz)
    for (int du = -reach_u; du <= reach_u; ++du)
      if (const double here = value(dz, du); here > best) {
        best = here;
        best_z = dz;
        best_u = du;
      }
  const double dz = best_z + Vertex(value(best_z - 1, best_u), best, value(best_z + 1, best_u));
  const double du = best_u + Vertex(value(best_z, best_u - 1), best, value(best_z, best_u + 1));
  return {(z0 + dz) * cell_m + robot.z_m, (u0 + du) * cell_m + robot.u_m};
}

}  // namespace cairn::local_map
