#include "pipelines/local_map/path/parts.h"

namespace cairn::local_map {

std::int32_t TraceAt(const Parts& parts, std::size_t robot, std::size_t sweep) {
  std::int32_t found = -1;
  for (std::size_t t = 0; t < parts.traces.size(); ++t)
    if (parts.traces[t].robot == robot && parts.traces[t].first <= sweep)
      found = static_cast<std::int32_t>(t);
  return found;
}

Point MovedBy(const RecordedTrace& trace, const std::vector<Knot>& knots) {
  Point sum;
  double count = 0;
  for (const Knot& knot : knots) {
    if (knot.robot != trace.robot || knot.sweep < trace.first || knot.sweep >= trace.end) continue;
    sum.x_m += knot.at.x_m - knot.dead.x_m;
    sum.y_m += knot.at.y_m - knot.dead.y_m;
    ++count;
  }
  return count > 0 ? Point{sum.x_m / count, sum.y_m / count} : Point{};
}

}  // namespace cairn::local_map
