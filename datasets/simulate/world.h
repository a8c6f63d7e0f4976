// A world of corridors as a graph: nodes are the places that a robot can tell (junctions, corners, dead
// ends).
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "schema/geometry.h"
#include "schema/rng.h"

namespace cairn::datasets {

// Nodes are landmarks. An edge is a straight corridor between two nodes, mostly along an axis.
struct CorridorWorld {
  std::vector<Point> nodes;
  std::vector<std::string> names;                    // of the nodes: "corner 0", "junction 3", "dead end 1"
  std::vector<std::vector<std::size_t>> neighbours;  // of each node, in increasing order
  std::size_t cycle_nodes = 0;                       // the first nodes are the big cycle, in order round it

  std::vector<std::pair<std::size_t, std::size_t>> Edges() const;  // each once, smaller index first
};

inline constexpr double kLoopBoxM = 90;  // edge of the box that a loop world fits in

// Twenty nodes in a box of `box_m`, drawn for 90 m and stretched to it: a cycle of 60 by 25 m with four
// corners and eight junctions, a corridor outwards from each junction. Two neighbouring ones on a long side
// join to a second, small cycle; the others are dead ends. The draw moves every node, and says which two
// join.
CorridorWorld MakeLoopWorld(double box_m, Rng& rng);

}  // namespace cairn::datasets
