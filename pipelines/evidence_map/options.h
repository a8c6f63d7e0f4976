// Options of evidence_map, each with unit, range and effect.
#pragma once

#include "pipelines/common/range_scans.h"

namespace cairn::evidence_map {

// p(m_xy | z), the inverse model of one kind of sensor.
struct InverseModel {
  double p_occupied;  // of the cells where a beam ends
  double p_free;      // of the cells before
};

struct Options {
  GridOptions grid;
  double prior = 0.5;
  InverseModel sonar{0.6, 0.45};
  InverseModel laser{0.7, 0.4};
  double wall_m = 0.1;
  bool graded = true;
  bool use_no_return = true;
  double clamp_nats = 20;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  VisitGridOptions(visit, o.grid);
  visit(Option{"prior", "", 0.001, 0.999, "p(m_xy), of a cell of which nothing is known"}, o.prior);
  visit(Option{"sonar_p_occupied", "", 0.001, 0.999, "p(m_xy | z) of the cells at a sonar's range"},
        o.sonar.p_occupied);
  visit(Option{"sonar_p_free", "", 0.001, 0.999, "of the cells in its cone before them"}, o.sonar.p_free);
  visit(Option{"laser_p_occupied", "", 0.001, 0.999, "p(m_xy | z) of the cell where a laser's ray ends"},
        o.laser.p_occupied);
  visit(Option{"laser_p_free", "", 0.001, 0.999, "of the cells that it crosses before"}, o.laser.p_free);
  visit(Option{"wall_m", "m", 0, 10, "cells this far from a sonar's range, and half a cell more, are at it"},
        o.wall_m);
  visit(Option{"graded", "", 0, 0, "a sonar says less of cells off its axis and, if free, far away"},
        o.graded);
  visit(Option{"use_no_return", "", 0, 0, "a beam without answer says that all within its reach is free"},
        o.use_no_return);
  visit(Option{"clamp_nats", "nat", 0.1, 1e9, "the log-odds that the map may hold at most, either way"},
        o.clamp_nats);
}

}  // namespace cairn::evidence_map
