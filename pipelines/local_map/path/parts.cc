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

}  // namespace cairn::local_map
