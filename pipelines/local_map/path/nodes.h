// Places along a path, close enough together that between them odometry's errors may be shared out evenly.
#pragma once

#include <cstddef>
#include <vector>

#include "pipelines/local_map/path/pose_graph.h"
#include "pipelines/local_map/path/runs.h"

namespace cairn::local_map {

struct NodeOptions {
  double apart_m = 0.5;
  double along_sd = 0.01;   // of the distance between two, a fraction of its square root's metre
  double across_sd = 0.02;  // to its side, likewise
  double gap_m = 0.3;       // sd across a gap in time
  double jump_m = 2;        // sd across a jump of odometry
  double slip_m = 0.2;      // sd of a way that scans show and odometry does not
};

// Of one robot, the first scan of each run and then one every apart_m travelled; the last scan too.
std::vector<std::size_t> ChooseNodes(const std::vector<Scan>& scans, const NodeOptions& options);

// From each of these nodes to the next, by the scans' poses. `first`: the number of the first node.
std::vector<OdometryEdge> MakeOdometryEdges(const std::vector<Scan>& scans,
                                            const std::vector<std::size_t>& nodes, std::int32_t first,
                                            const NodeOptions& options);

// The scans' poses with the nodes where `placed` says; what it moves them by is shared out over the way.
void MoveTo(const std::vector<std::size_t>& nodes, const Point* placed, std::vector<Scan>* scans);

}  // namespace cairn::local_map
