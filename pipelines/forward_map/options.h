// Options of forward_map, each with unit, range and effect.
#pragma once

#include <cstdint>

#include "pipelines/common/range_scans.h"

namespace cairn::forward_map {

struct Options {
  GridOptions grid;
  double p_hit = 0.7;
  double p_rand = 0.05;
  double p_lost = 0.01;
  double sigma_m = 0;
  double max_range_m = 0;
  bool no_echo = true;
  bool estimate = true;
  double prior = 0.5;
  double smoothness = 0;
  bool swaps = true;
  std::int64_t pair_cells = 2000;
  double anneal = 1;
  std::int64_t rounds = 12;
  double dynamic_nats = 10;
  double tile_mcrossings = 4;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  VisitGridOptions(visit, o.grid);
  visit(Option{"p_hit", "", 0.02, 0.99, "P(an obstacle in a beam is detected); with estimate, to begin with"},
        o.p_hit);
  visit(Option{"p_rand", "", 1e-4, 0.9, "P(a reading is of nothing); with estimate, to begin with"},
        o.p_rand);
  visit(Option{"p_lost", "", 0, 0.5, "P(a reading has no echo, whatever stands there)"}, o.p_lost);
  visit(
      Option{"sigma_m", "m", 0, 10,
             "sd of a range; 0: of cones the log's noise/sonar_m, else 0.05, but half a cell at least; with "
             "estimate, to begin with"},
      o.sigma_m);
  visit(Option{"max_range_m", "m", 0, 1e4,
               "z_max: readings at it and beyond count as without echo; 0: what the log says of the sensor"},
        o.max_range_m);
  visit(
      Option{"no_echo", "", 0, 0, "a reading without echo tells of the absence of obstacles; or of nothing"},
      o.no_echo);
  visit(Option{"estimate", "", 0, 0, "p_hit, p_rand and sigma_m of each sensor from the data, by EM"},
        o.estimate);
  visit(Option{"prior", "", 0.001, 0.999, "P(a cell is occupied) before any data; 0.5: maximum likelihood"},
        o.prior);
  visit(Option{"smoothness", "nat", 0, 100, "that each pair of unlike cells side by side costs"},
        o.smoothness);
  visit(Option{"swaps", "", 0, 0, "also try to move obstacles to neighbouring cells"}, o.swaps);
  visit(Option{"pair_cells", "", 0, 1e9,
               "also try to flip two cells at once that share a reading, in tiles of up to so many cells: in "
               "larger ones it gains next to nothing and takes most of the time; 0: never"},
        o.pair_cells);
  visit(Option{"anneal", "", 1, 16,
               "also search with sigma so many times as large, then by halves down to itself; the better of "
               "both maps is taken; 1: not"},
        o.anneal);
  visit(Option{"rounds", "", 1, 1000, "searches of all tiles at most; it ends earlier where none finds more"},
        o.rounds);
  visit(
      Option{"dynamic_nats", "nat", 0.1, 1e6,
             "by how much an obstacle that came and went must explain readings better than one that stayed, "
             "to be marked as dynamic"},
      o.dynamic_nats);
  visit(Option{"tile_mcrossings", "million", 0.01, 1000,
               "cells of beams, in millions, that a task of the search may hold; 30 MB or so each"},
        o.tile_mcrossings);
}

}  // namespace cairn::forward_map
