#include "pipelines/local_map/path/pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cairn::local_map {
namespace {

// A difference of two places of the local frame along a trace, and back.
Position AlongQuarter(int quarter, double dx, double dy) { return TraceFrame{quarter, {}}.At({dx, dy}, 1); }
Point Across(int quarter, const Position& by) { return TraceFrame{quarter, {}}.Local(by, 1); }

// Nodes of the path over which a trace was recorded.
std::vector<std::size_t> OwnNodes(const std::vector<PathNode>& nodes, const RecordedTrace& trace) {
  std::vector<std::size_t> own;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (nodes[k].robot == trace.robot && nodes[k].scan >= trace.first && nodes[k].scan < trace.end)
      own.push_back(k);
  return own;
}

// Where the path has the node in the trace's frame, by the nearest of the trace's own.
Position PlaceOn(const PathNode& node, const std::vector<std::size_t>& own,
                 const std::vector<PathNode>& nodes, const RecordedTrace& trace) {
  const PathNode* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t k : own) {
    const double off = std::hypot(node.at.x_m - nodes[k].at.x_m, node.at.y_m - nodes[k].at.y_m);
    if (off >= least) continue;
    least = off;
    nearest = &nodes[k];
  }
  const Position there = trace.frame.At(nearest->dead, trace.trace.cell_m());
  const Position by =
      AlongQuarter(trace.frame.quarter, node.at.x_m - nearest->at.x_m, node.at.y_m - nearest->at.y_m);
  return {there.z_m + by.z_m, there.u_m + by.u_m};
}

}  // namespace

std::vector<Pair> ChoosePairs(const std::vector<PathNode>& nodes, const std::vector<RecordedTrace>& traces,
                              double wider, const PairOptions& options) {
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < traces.size(); ++t) {
    const RecordedTrace& trace = traces[t];
    const std::vector<std::size_t> own = OwnNodes(nodes, trace);
    if (own.empty()) continue;
    const double from_m = nodes[own.front()].path_m, to_m = nodes[own.back()].path_m;
    // Beyond the way's ends a trace holds what was seen of them from there, from one side.
    const double cell_m = trace.trace.cell_m();
    const double first_m = trace.frame.At(nodes[own.front()].dead, cell_m).z_m - options.beyond_m;
    const double last_m = trace.frame.At(nodes[own.back()].dead, cell_m).z_m + options.beyond_m;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (nodes[k].robot != trace.robot) continue;
      const double distance_m = std::max(from_m - nodes[k].path_m, nodes[k].path_m - to_m);
      if (distance_m < options.loop_m) continue;
      const double range_m =
          std::min(options.most_m, wider * (options.range_m + options.range_per_m * distance_m));
      const Position at = PlaceOn(nodes[k], own, nodes, trace);
      if (std::abs(at.u_m) > options.aside_m + range_m) continue;
      if (at.z_m < first_m - range_m || at.z_m > last_m + range_m) continue;
      pairs.push_back({static_cast<std::int32_t>(k), static_cast<std::int32_t>(t), at, range_m});
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::node);
  return pairs;
}

Candidate MatchPair(const Pair& pair, const RecordedTrace& trace, const EdgeTrace& surroundings,
                    const Position& robot, const PairOptions& options) {
  const Position origin{pair.at.z_m - robot.z_m, pair.at.u_m - robot.u_m};
  // [DM98] section 4.3: loops, which are found off-line
  std::vector<Candidate> found =
      FindOn(trace.trace, surroundings, origin, {pair.range_m, pair.range_m}, options.find);
  if (found.empty()) return {};
  found[0].z_m += robot.z_m;
  found[0].u_m += robot.u_m;
  return found[0];
}

LoopConstraint MakeLoopConstraint(const Pair& pair, const Candidate& match,
                                  const std::vector<PathNode>& nodes, const RecordedTrace& trace,
                                  const PairOptions& options) {
  std::size_t nearest = 0;
  Position there;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t k : OwnNodes(nodes, trace)) {
    const Position at = trace.frame.At(nodes[k].dead, trace.trace.cell_m());
    const double off = std::abs(at.z_m - match.z_m);
    if (off >= least) continue;
    least = off;
    nearest = k;
    there = at;
  }
  LoopConstraint constraint;
  constraint.from = static_cast<std::int32_t>(nearest);
  constraint.to = pair.node;
  constraint.offset = Across(trace.frame.quarter, {match.z_m - there.z_m, match.u_m - there.u_m});
  constraint.axis_rad = trace.frame.quarter * std::numbers::pi / 2;
  const auto sd = [&](double sd_m, double confidence, double least_m) {
    const bool told = confidence >= options.confidence && sd_m <= options.most_sd_m;
    return told ? std::hypot(sd_m, least_m) : std::numeric_limits<double>::infinity();
  };
  constraint.sd_z_m = sd(match.sd_z_m, match.confidence_z, options.least_sd_z_m);
  constraint.sd_u_m = sd(match.sd_u_m, match.confidence_u, options.least_sd_m);
  constraint.quality = std::max(match.confidence_z, match.confidence_u);
  return constraint;
}

}  // namespace cairn::local_map
