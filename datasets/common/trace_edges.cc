#include "datasets/common/trace_edges.h"

#include <cmath>

#include "schema/kinds/local_map.h"

namespace cairn::datasets {

std::vector<std::vector<Point>> TraceEdges(const Blob& result) {
  std::vector<std::vector<Point>> edges;
  if (!result.Has("traces/robot")) return edges;
  const auto map = FieldsIn<kinds::LocalMap>("", result);
  edges.resize(map.robot.size());
  const kinds::LocalMap::Traces& traces = map.traces;
  std::size_t next = 0;
  for (std::size_t k = 0; k < traces.robot.size(); ++k) {
    const double c = std::cos(traces.direction_rad[k]), s = std::sin(traces.direction_rad[k]);
    for (std::int64_t f = 0; f < traces.features[k]; ++f, ++next) {
      const double z_m = static_cast<double>(traces.first_z[k] + f) * map.cell_m.Scalar();
      const auto add = [&](const kinds::LocalMap::Side& side, double sign) {
        // A row of which one number is missing is no edge.
        const double u_m = sign * (double{side.distance_low_m[next]} + side.distance_high_m[next]) / 2;
        if (side.occupied[next] == 0 ||
            std::isnan(u_m + side.angle_low_rad[next] + side.angle_high_rad[next]))
          return;
        edges[static_cast<std::size_t>(traces.robot[k])].push_back(
            {traces.x_m[k] + c * z_m - s * u_m, traces.y_m[k] + s * z_m + c * u_m});
      };
      add(map.left, 1);
      add(map.right, -1);
    }
  }
  return edges;
}

}  // namespace cairn::datasets
