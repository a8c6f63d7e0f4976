#include "datasets/import/step_arcs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "schema/kinds/odometry_steps.h"

namespace cairn::datasets {

namespace {

int PiecesOf(double turn_rad) {
  constexpr double kMostTurn_rad = 0.05, kMost = 100;
  return static_cast<int>(std::clamp(std::ceil(std::abs(turn_rad) / kMostTurn_rad), 1.0, kMost));
}

}  // namespace

void TakeStepsAsArcs(Odometry* odometry) {
  Odometry arcs(odometry->time_s.folder());
  arcs.from.file = odometry->from.file;
  arcs.from.before_line = odometry->from.before_line;
  const bool has_lines = odometry->from.line.size() == odometry->time_s.size();
  double before_s = odometry->time_s.empty() ? 0 : odometry->time_s[0];
  for (std::size_t i = 0; i < odometry->time_s.size(); ++i) {
    const double time_s = odometry->time_s[i];
    const int pieces = time_s > before_s ? PiecesOf(odometry->turn_rad[i]) : 1;
    const double turn = odometry->turn_rad[i] / pieces, way = odometry->forward_m[i] / pieces;
    for (int k = 1; k <= pieces; ++k) {
      const double at_s = k == pieces ? time_s : before_s + (time_s - before_s) * k / pieces;
      const bool both = turn != 0 && way != 0;
      arcs.Add(at_s, both ? turn / 2 : turn, both ? ChordOfArc(way, turn) : way);
      if (both) arcs.Add(at_s, turn / 2, 0);
    }
    before_s = time_s;
    if (has_lines) arcs.from.line.resize(arcs.time_s.size(), odometry->from.line[i]);
  }
  *odometry = std::move(arcs);
}

std::string DoubtLongSteps(const Odometry& odometry) {
  constexpr double kLong_m = 0.25;
  constexpr std::size_t kFewRows = 20;
  const double half_m = std::abs(HalfStep_m(odometry.time_s, odometry.turn_rad, odometry.forward_m));
  if (half_m < kLong_m || odometry.time_s.size() < kFewRows) return "";
  return fmt::format(
      "its rows turn and go at once, some {:.1f} m where it turns, and are read as first the turn, then the "
      "way: of "
      "a robot that turns along the way, as wheels do, say --steps-are-arcs",
      2 * half_m);
}

}  // namespace cairn::datasets
