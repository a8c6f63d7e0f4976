#include "pipelines/local_map/path/parts.h"

namespace cairn::local_map {

std::int32_t TraceAt(const Parts& parts, std::size_t robot, std::size_t scan) {
  std::int32_t found = -1;
  for (std::size_t t = 0; t < parts.traces.size(); ++t)
    if (parts.traces[t].robot == robot && parts.traces[t].first <= scan) found = static_cast<std::int32_t>(t);
  return found;
}

Point MovedBy(const RecordedTrace& trace, const std::vector<PathNode>& nodes) {
  Point sum;
  double count = 0;
  for (const PathNode& node : nodes) {
    if (node.robot != trace.robot || node.scan < trace.first || node.scan >= trace.end) continue;
    sum.x_m += node.at.x_m - node.dead.x_m;
    sum.y_m += node.at.y_m - node.dead.y_m;
    ++count;
  }
  return count > 0 ? Point{sum.x_m / count, sum.y_m / count} : Point{};
}

std::vector<Point> EdgesOf(const std::vector<RecordedTrace>& traces, const std::vector<PathNode>& nodes) {
  std::vector<Point> edges;
  for (const RecordedTrace& recorded : traces) {
    const Point by = MovedBy(recorded, nodes);
    const EdgeTrace& trace = recorded.trace;
    for (int z = trace.first_z(); z < trace.end_z(); ++z) {
      const Feature& feature = *trace.Find(z);
      for (const double sign : {1.0, -1.0}) {
        const Side& side = sign > 0 ? feature.left : feature.right;
        if (!side.distance_m.known() || side.occupied == 0) continue;
        const Point at =
            recorded.frame.Local({z * trace.cell_m(), sign * side.distance_m.centre()}, trace.cell_m());
        edges.push_back({at.x_m + by.x_m, at.y_m + by.y_m});
      }
    }
  }
  return edges;
}

}  // namespace cairn::local_map
