// Which nodes may lie on which traces, and what matching says of them.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/local_map/path/pose_graph.h"
#include "pipelines/local_map/traces/arrays.h"
#include "pipelines/local_map/traces/find_on.h"
#include "pipelines/pipeline.h"
#include "schema/kinds/fields.h"

namespace cairn::local_map {

struct PairOptions {
  double loop_m = 6;           // travelled between them, at least: what is nearer odometry knows better
  double aside_m = 0.3;        // to the side of a trace's way
  double beyond_m = 0.3;       // the ends of the path over which it was recorded
  double range_m = 0.3;        // searched around where the path says, and
  double range_per_m = 0.015;  // travelled more,
  double most_m = 1.5;         // up to so much
  double confidence = 0.9;     // that a match must have
  double least_sd_m = 0.05;    // that its u is believed to have, at best,
  double least_sd_z_m = 0.15;  // and its z
  double most_sd_m = 0.15;     // beyond that it tells nothing
  FindOptions find;
};

// A place that a robot was at.
struct PathNode {
  std::size_t robot = 0, scan = 0;
  double path_m = 0;
  Point dead;  // in the frame that traces were recorded in
  Point at;    // where the path has it now
};

// A node that may lie on a trace.
struct Pair {
  std::int32_t node = 0, trace = 0;
  Position at;  // in the trace's frame, by the path
  double range_m = 0;
  static void Fields(const auto& field) {
    field("node", &Pair::node);
    field("trace", &Pair::trace);
    field("at", &Pair::at);
    field("range_m", &Pair::range_m);
  }
};

// Of each node, the traces of its robot that the path says are near.
std::vector<Pair> ChoosePairs(const std::vector<PathNode>& nodes, const std::vector<RecordedTrace>& traces,
                              double wider, const PairOptions& options);

// The surroundings of a node in the direction of the trace, sought on it. A confidence of 0: nothing could be
// compared.
Candidate MatchPair(const Pair& pair, const RecordedTrace& trace, const EdgeTrace& surroundings,
                    const Position& robot, const PairOptions& options);

// What a match says of the node, and of that node of the trace's own way which is nearest to it.
LoopConstraint MakeLoopConstraint(const Pair& pair, const Candidate& match,
                                  const std::vector<PathNode>& nodes, const RecordedTrace& trace,
                                  const PairOptions& options);

}  // namespace cairn::local_map
