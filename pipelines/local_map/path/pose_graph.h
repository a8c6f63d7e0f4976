// One path of all that traces say of each other: given the headings, which walls tell, positions are a linear
// least-squares problem.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/local_map/grids/plane.h"

namespace cairn::local_map {

// Nodes are places that the robot passed, in order of time. What odometry says of two that follow each other,
// in the frame of the walls.
struct OdometryEdge {
  std::int32_t from = 0, to = 0;
  Point offset;
  double along_m = 0, across_m = 0;  // sd along the way and to its side
};

// What matching says: the robot at `to` is at `offset` from where it was at `from`.
struct LoopConstraint {
  std::int32_t from = 0, to = 0;
  Point offset;
  double axis_rad = 0;            // of the z axis
  double sd_z_m = 0, sd_u_m = 0;  // along it and to its left; infinite: not known
  double quality = 1;
  static void Fields(const auto& field) {
    field("from", &LoopConstraint::from);
    field("to", &LoopConstraint::to);
    field("offset", &LoopConstraint::offset);
    field("axis_rad", &LoopConstraint::axis_rad);
    field("sd_z_m", &LoopConstraint::sd_z_m);
    field("sd_u_m", &LoopConstraint::sd_u_m);
    field("quality", &LoopConstraint::quality);
  }
};

struct PoseGraphOptions {
  double gate = 3.0;  // standard deviations beyond which a loop constraint is taken to be of another place
  int rounds = 30;    // of reweighting
};

struct OptimizedGraph {
  std::vector<Point> node;     // the first of each connected part stays where it is
  std::vector<double> weight;  // of each loop constraint, 0: contradicted by the others, 1: followed
};

// Minimises the sum over odometry edges and loop constraints of squared residuals in standard deviations;
// loop constraints by a bounded loss (Geman and McClure), whose bound is reached from a wide one step by step
// (graduated non-convexity: Yang, Antonante, Tzoumas, Carlone 2020), so that a few wrong loops have no pull
// in the end. `start`: [nodes] where they are before; the first node of each part is held there.
OptimizedGraph OptimizePoseGraph(const std::vector<Point>& start,
                                 const std::vector<OdometryEdge>& odometry_edges,
                                 const std::vector<LoopConstraint>& constraints,
                                 const PoseGraphOptions& options);

}  // namespace cairn::local_map
