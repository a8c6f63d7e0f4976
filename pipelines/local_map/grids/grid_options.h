// Options of the local grids, each with unit, range and effect.
#pragma once

#include <cstdint>

#include "pipelines/common/options.h"
#include "pipelines/local_map/grids/wall_orientation.h"

namespace cairn::local_map {

// What makes a line of hits an edge ([DM98] figure 1). A unit is the edge of a cell, at most `unit_m`.
struct LineFitRule {
  double unit_m = 0.12;       // hits that far from a line belong to it, in cells of any size
  double gap_m = 0.7;         // neighbouring hits of a candidate are no further apart,
  double bend = 0.08;         // nor off its chord by more than this part of it, nor by more than a unit
  double hole_m = 0.6;        // the longest part of an edge without hits, and no less than two cells
  double spread_m = 0.045;    // of an edge's hits about it, root mean square
  double min_length_m = 0.6;  // of an edge
  int min_hits = 4;           // that it is fitted to
  double max_turn_rad = 0.2;  // of a candidate by the fit
};

struct GridOptions {
  double cell_m = 0.15;
  std::int64_t half_cells = 15;
  double occupancy_kept = 0.95;
  double occupied = 0.08;
  double edges_kept = 0.99;
  double walls_kept = 0.97;
  bool align = true;
  LineFitRule line{};
  PeakRule edge_peak{0.6, 1.5};
  PeakRule wall_peak{0.6, 5};  // weight in 1/deg^2
};

template <class V>
void VisitGridOptions(V& visit, GridOptions& o) {
  visit(Option{"cell_m", "m", 0, 2, "edge of a cell of the local grids; 0: 0.15, in a hall 0.3"}, o.cell_m);
  visit(
      Option{"half_cells", "", 0, 127,
             "the grids reach so many cells from the robot's to each side; 0: 15; in a hall, that is, where "
             "on more than 15% of a robot's way, 5 m and more at a stretch, less than 5% of a laser's beams "
             "end within 2.25 m, as many as three quarters of the readings of 90% of the way reach, 60 at "
             "most"},
      o.half_cells);
  visit(Option{"occupancy_kept", "", 0, 0.999, "of the counts of hits that much is kept each scan"},
        o.occupancy_kept);
  visit(Option{"occupied", "", 0, 1, "hits a scan from which a cell counts as occupied"}, o.occupied);
  visit(Option{"edges_kept", "", 0, 0.9999, "of the edge grid's histograms that much is kept each scan"},
        o.edges_kept);
  visit(Option{"walls_kept", "", 0, 0.9999, "of the histogram of wall orientations, likewise"}, o.walls_kept);
  visit(Option{"align", "", 0, 0,
               "turn the grids to where the walls' dominant orientation lies along the axes"},
        o.align);
}

}  // namespace cairn::local_map
