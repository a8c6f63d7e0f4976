// Options of local_map, each with unit, range and effect.
#pragma once

#include <cstdint>
#include <string>

#include "pipelines/common/options.h"
#include "pipelines/local_map/grids/grid_options.h"
#include "pipelines/local_map/path/localizer.h"
#include "pipelines/local_map/path/nodes.h"
#include "pipelines/local_map/path/orientation_track.h"
#include "pipelines/local_map/path/pairs.h"
#include "pipelines/local_map/path/pose_graph.h"
#include "pipelines/local_map/path/runs.h"
#include "pipelines/local_map/tasks/trace_task.h"

namespace cairn::local_map {

struct Options {
  GridOptions grid{.cell_m = 0, .half_cells = 0};  // and ring_beams: 0 where size.h chooses
  std::string sensors;
  std::int64_t ring_beams = 0;
  RunOptions runs;
  OrientationOptions orientation;
  RecordOptions record;
  NodeOptions nodes;
  PairOptions pairs;
  std::int64_t loop_rounds = 3, loop_mends = 3;
  LocalizerOptions localizer;
  PoseGraphOptions pose_graph;
  std::int64_t segment_scans = 500;
  std::int64_t warm_up_scans = 60;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  VisitGridOptions(visit, o.grid);
  visit(Option{"sensors", "", 0, 0,
               "of which sensors, by commas: sonar, infrared, laser, laser2 to laser5; empty: all"},
        o.sensors);
  visit(Option{"ring_beams", "", 0, 720,
               "a laser is thinned to so many beams around the full circle, each the nearest of its sector; "
               "0: 72, in a hall 180"},
        o.ring_beams);
  visit(Option{"jump_mps", "m/s", 0.1, 1e6,
               "a control of a way that is faster is a jump: the run is cut there"},
        o.runs.jump_mps);
  visit(Option{"jump_radps", "rad/s", 0.1, 1e6, "of a turn, likewise"}, o.runs.jump_radps);
  visit(Option{"gap_s", "s", 0.1, 1e9, "without a reading for so long, the run is cut and grids begin anew"},
        o.runs.gap_s);
  visit(Option{"heading_walk", "rad/sqrt(m)", 1e-3, 1,
               "sd of the random walk of odometry's heading at most; how large it is, the walls tell"},
        o.orientation.walk_rad_per_sqrt_m);
  visit(Option{"turn_ratio", "", 0, 1, "sd of a turn's error by odometry, a fraction of the turn, likewise"},
        o.orientation.turn_ratio);
  visit(Option{"walls_sd_rad", "rad", 1e-4, 1, "sd of the walls' orientation as one scan shows it"},
        o.orientation.seen_rad);
  visit(Option{"trace_least_m", "m", 0.2, 100, "a trace over a shorter distance is none"}, o.record.least_m);
  visit(Option{"node_m", "m", 0.1, 10,
               "travelled, after which what is around the robot is matched with traces"},
        o.nodes.apart_m);
  visit(Option{"along_sd", "sqrt(m)", 1e-4, 1, "sd of 1 m travelled by odometry, along it"},
        o.nodes.along_sd);
  visit(Option{"aside_sd", "sqrt(m)", 1e-4, 1, "likewise to its side, once headings are corrected"},
        o.nodes.across_sd);
  visit(Option{"loop_rounds", "", 0, 20, "rounds of matching, each around the path that the one before gave"},
        o.loop_rounds);
  visit(
      Option{"loop_mends", "", 0, 20,
             "how often the path is sought anew where a laser's scans of many places contradict it, at most"},
      o.loop_mends);
  visit(Option{"loop_m", "m", 0.5, 1e6, "travelled between two places that are matched, at least"},
        o.pairs.loop_m);
  visit(Option{"loop_aside_m", "m", 0, 10, "to the side of a trace's way that a place may be, to be matched"},
        o.pairs.aside_m);
  visit(Option{"loop_beyond_m", "m", -10, 10, "beyond the way's ends, likewise"}, o.pairs.beyond_m);
  visit(Option{"loop_sd_m", "m", 0.001, 10, "sd that a match has at best, to the side of the trace's way"},
        o.pairs.least_sd_m);
  visit(Option{"loop_sd_along_m", "m", 0.001, 10, "likewise along it"}, o.pairs.least_sd_z_m);
  visit(Option{"loop_confidence", "", 0, 1, "that a match has the right place on a trace"},
        o.pairs.confidence);
  visit(Option{"loop_range_m", "m", 0.05, 10, "searched around where the path says, at least"},
        o.pairs.range_m);
  visit(Option{"loop_range_ratio", "", 0, 1, "more for each metre travelled between"}, o.pairs.range_per_m);
  visit(Option{"loop_most_m", "m", 0.05, 10, "but no more than that"}, o.pairs.most_m);
  visit(Option{"loop_null", "", -10, 10, "similarity a comparable side that unrelated places reach"},
        o.pairs.find.null_score);
  visit(Option{"loop_gate", "", 0.5, 100,
               "standard deviations beyond which a loop contradicts the rest and is not followed"},
        o.pose_graph.gate);
  visit(Option{"range_per_m", "", 0, 1, "by which the live localizer's ranges grow, a metre travelled"},
        o.localizer.range_per_m);
  visit(Option{"range_least_m", "m", 0.01, 10, "they never fall below"}, o.localizer.least_m);
  visit(Option{"range_most_m", "m", 0.1, 10, "nor grow beyond, unless the robot is lost"},
        o.localizer.most_m);
  visit(Option{"lost_m", "m", 0.1, 1e6, "travelled without any correction, after which the robot is lost"},
        o.localizer.lost_m);
  visit(Option{"lost_range_m", "m", 0.1, 10, "ranges grow up to this then"}, o.localizer.lost_most_m);
  visit(Option{"segment_scans", "", 50, 1e6, "scans of a task"}, o.segment_scans);
  visit(Option{"warm_up_scans", "", 0, 1e5, "scans before a task's own, from which its grids begin"},
        o.warm_up_scans);
}

}  // namespace cairn::local_map
