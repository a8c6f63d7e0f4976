#include "pipelines/local_map/path/nodes.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {

std::vector<std::size_t> ChooseNodes(const std::vector<Scan>& scans, const NodeOptions& options) {
  std::vector<std::size_t> nodes;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (nodes.empty() || scans[s].run != scans[s - 1].run || s + 1 == scans.size() ||
        scans[s].path_m - scans[nodes.back()].path_m >= options.apart_m)
      nodes.push_back(s);
  }
  return nodes;
}

std::vector<OdometryEdge> MakeOdometryEdges(const std::vector<Scan>& scans,
                                            const std::vector<std::size_t>& nodes, std::int32_t first,
                                            const NodeOptions& options) {
  constexpr double kLeast_m = 0.005;
  std::vector<OdometryEdge> odometry_edges;
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const Scan &from = scans[nodes[k - 1]], &to = scans[nodes[k]];
    OdometryEdge odometry_edge;
    odometry_edge.from = first + static_cast<std::int32_t>(k) - 1;
    odometry_edge.to = odometry_edge.from + 1;
    odometry_edge.offset = {to.pose.x_m - from.pose.x_m, to.pose.y_m - from.pose.y_m};
    const double root = std::sqrt(to.path_m - from.path_m);
    const bool cut = to.run != from.run;
    const bool slipped = std::any_of(scans.begin() + static_cast<std::ptrdiff_t>(nodes[k - 1]) + 1,
                                     scans.begin() + static_cast<std::ptrdiff_t>(nodes[k]) + 1,
                                     [](const Scan& scan) { return scan.slipped; });
    const double more = cut ? to.jumped ? options.jump_m : options.gap_m : slipped ? options.slip_m : 0;
    odometry_edge.along_m = std::hypot(options.along_sd * root, kLeast_m, more);
    odometry_edge.across_m = std::hypot(options.across_sd * root, kLeast_m, more);
    odometry_edges.push_back(odometry_edge);
  }
  return odometry_edges;
}

void MoveTo(const std::vector<std::size_t>& nodes, const Point* placed, std::vector<Scan>* scans) {
  const std::vector<Scan> before = *scans;
  const auto moved = [&](std::size_t k) {
    const Pose& pose = before[nodes[k]].pose;
    return Point{placed[k].x_m - pose.x_m, placed[k].y_m - pose.y_m};
  };
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const bool last = k + 1 == nodes.size();
    const std::size_t end = last ? before.size() : nodes[k + 1];
    const Point here = moved(k), there = last ? here : moved(k + 1);
    const double distance_m = last ? 0 : before[nodes[k + 1]].path_m - before[nodes[k]].path_m;
    const bool cut = !last && before[nodes[k + 1]].run != before[nodes[k]].run;
    for (std::size_t s = nodes[k]; s < end; ++s) {
      const double part =
          distance_m > 0 && !cut ? (before[s].path_m - before[nodes[k]].path_m) / distance_m : 0;
      (*scans)[s].pose.x_m += here.x_m + part * (there.x_m - here.x_m);
      (*scans)[s].pose.y_m += here.y_m + part * (there.y_m - here.y_m);
    }
  }
}

}  // namespace cairn::local_map
