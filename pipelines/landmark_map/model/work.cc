#include "pipelines/landmark_map/model/work.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>

namespace cairn::landmark_map {
namespace {

constexpr double kMargin = 4.0;  // cells: one itself, and what a move adds before it is pruned

// Second moments of a pose whose heading correction h turns the ways that follow, in cells and rad.
struct Spread {
  double hh = 0, hx = 0, hy = 0, xx = 0, xy = 0, yy = 0;

  void TurnBy(double variance) { hh += variance; }
  // A motion increment (dx, dy) with an error along it; the grid's bilinear shift blurs by a sixth of a cell
  // squared.
  void Move(double dx, double dy, double along_sd) {
    const double nx = -dy, ny = dx, length = std::hypot(dx, dy);
    const double ux = length > 0 ? dx / length : 0.0, uy = length > 0 ? dy / length : 0.0;
    const double along = along_sd * along_sd, blur = length > 0 ? 1.0 / 6.0 : 0.0;
    xx += 2.0 * nx * hx + hh * nx * nx + along * ux * ux + blur;
    xy += nx * hy + ny * hx + hh * nx * ny + along * ux * uy;
    yy += 2.0 * ny * hy + hh * ny * ny + along * uy * uy + blur;
    hx += hh * nx;
    hy += hh * ny;
  }
  // Cells of the boxes, a heading at a time, of what lies within `reach` standard deviations.
  double Cells(double reach, const GridSpec& grid, double travelled, double limit) const {
    const double step = 2.0 * std::numbers::pi / grid.headings;
    const int far = std::min(grid.headings / 2, static_cast<int>(std::ceil(reach * std::sqrt(hh) / step)));
    const double given_x = hh > 0 ? xx - hx * hx / hh : xx, given_y = hh > 0 ? yy - hy * hy / hh : yy;
    double cells = 0.0;
    for (int c = -far; c <= far; ++c) {
      const double left = std::max(0.0, reach * reach - (hh > 0 ? c * step * c * step / hh : 0.0));
      const auto edge = [&](double variance) {
        const double wide = 2.0 * std::sqrt(left * std::max(0.0, variance));
        return std::min({wide, 2.0 * travelled, limit}) + kMargin;
      };
      cells += edge(given_x) * edge(given_y);
    }
    return cells;
  }
  // The box of all headings' boxes, around where odometry is.
  Box Around(double x, double y, double reach, double travelled, double limit) const {
    const auto half = [&](double variance) {
      return 0.5 *
             (std::min({2.0 * reach * std::sqrt(std::max(0.0, variance)), 2.0 * travelled, limit}) + kMargin);
    };
    const double rx = half(xx), ry = half(yy);
    return {static_cast<std::int32_t>(std::floor(x - rx)), static_cast<std::int32_t>(std::floor(y - ry)),
            static_cast<std::int32_t>(std::ceil(2.0 * rx)), static_cast<std::int32_t>(std::ceil(2.0 * ry))};
  }
};

constexpr double kLeast = 1e-9;  // without pruning taps still end somewhere

double Reach(const EStepModel& model) { return std::sqrt(-2.0 * std::log(std::max(model.prune, kLeast))); }

void MoveAlong(const MotionIncrement& increment, const EStepModel& model, Spread* spread) {
  const IncrementError error = ErrorOf(increment, model.noise);
  const double half_turn = 0.5 * error.heading_rad * error.heading_rad, cell = model.grid.cell_m;
  spread->TurnBy(half_turn);
  spread->Move(increment.dx_m / cell, increment.dy_m / cell, error.along_m / cell);
  spread->TurnBy(half_turn);
}

}  // namespace

OpenLoop ReckonOpenLoop(const RobotSteps& steps, const EStepModel& model, int count) {
  const double reach = Reach(model);
  const double cell = model.grid.cell_m;
  const double limit = model.limit.empty() ? HUGE_VAL : model.limit.nx;
  const double whole = static_cast<double>(model.limit.cells()) * model.grid.headings;
  Spread spread;
  double travelled = 0.0;
  OpenLoop reckoned;
  for (int s = 0; s < count; ++s) {
    const MotionIncrement increment = steps.IncrementTo(s);
    travelled += increment.path_m / cell;
    MoveAlong(increment, model, &spread);
    reckoned.cells.push_back(model.whole_tables ? whole : spread.Cells(reach, model.grid, travelled, limit));
    reckoned.boxes.push_back(
        spread.Around(steps.odo_x_m[s] / cell, steps.odo_y_m[s] / cell, reach, travelled, limit));
  }
  for (int s = count; s < steps.size(); ++s) {
    reckoned.boxes.push_back(
        Spread{}.Around(steps.odo_x_m[s] / cell, steps.odo_y_m[s] / cell, reach, travelled, limit));
  }
  return reckoned;
}

double WorkOf(const std::vector<double>& cells, int count) {
  double work = 0.0;
  for (int s = 0; s < count; ++s) work += cells[static_cast<std::size_t>(s)] + kStepCells;
  return work;
}

double MeanCellsInAMap(const RobotSteps& steps, const EStepModel& model) {
  if (model.whole_tables) return static_cast<double>(model.limit.cells()) * model.grid.headings;
  const double reach = Reach(model);
  double cells = 0.0, travelled = 0.0;
  Spread spread;
  for (int s = 0; s < steps.size(); ++s) {
    const MotionIncrement increment = steps.IncrementTo(s);
    travelled += increment.path_m / model.grid.cell_m;
    MoveAlong(increment, model, &spread);
    cells += spread.Cells(reach, model.grid, travelled, HUGE_VAL);
    if (steps.first_observation[s + 1] == steps.first_observation[s]) continue;
    spread = {};
    travelled = 0.0;
  }
  return cells / steps.size();
}

int FirstReturn(const RobotSteps& steps, const OpenLoop& loop, const EStepModel& model) {
  struct Place {
    int x, y;
    bool left;  // the belief has been elsewhere since
  };
  std::vector<Place> places;
  for (int s = 0; s < static_cast<int>(loop.boxes.size()); ++s) {
    const bool observes = steps.first_observation[s + 1] > steps.first_observation[s];
    for (Place& place : places) {
      const bool inside = loop.boxes[s].Contains(place.x, place.y);
      if (inside && place.left && observes) return s;
      place.left = place.left || !inside;
    }
    const double cell = model.grid.cell_m;
    if (observes)
      places.push_back({static_cast<int>(std::lround(steps.odo_x_m[s] / cell)),
                        static_cast<int>(std::lround(steps.odo_y_m[s] / cell)), false});
  }
  return steps.size();
}

double WorkOfStep(const RobotSteps& steps, const EStepModel& model) {
  return kStepCells + kBlur * MeanCellsInAMap(steps, model);
}

double WorkInAMapUpTo(int known, int count, double least, const RobotSteps& steps, const EStepModel& model) {
  if (model.whole_tables) return least * count;
  const double reach = Reach(model);
  const auto& first = steps.first_observation;
  std::set<std::int32_t> types;
  double work = 0.0, travelled = 0.0;
  Spread spread;
  for (int s = 0; s < count; ++s) {
    const MotionIncrement increment = steps.IncrementTo(s);
    travelled += increment.path_m / model.grid.cell_m;
    MoveAlong(increment, model, &spread);
    work += std::max(least, kStepCells + spread.Cells(reach, model.grid, travelled, HUGE_VAL));
    bool tells = false;
    for (int k = first[s]; k < first[s + 1]; ++k) {
      const std::int32_t type = steps.observations[static_cast<std::size_t>(k)].type;
      if (s < known) types.insert(type);
      tells = tells || types.contains(type);
    }
    if (!tells) continue;
    spread = {};
    travelled = 0.0;
  }
  return work;
}

double CellNanoseconds(const RobotSteps& steps, const EStepModel& model, bool in_cache) {
  constexpr double kAlways_ns = 4.0;                       // scaling, pruning, products
  constexpr double kCached_ns = 0.35, kUncached_ns = 1.0;  // of a tap
  constexpr double kObservation = 4.0;                     // taps: a bilinear shift
  const int increments = steps.size() - 1;
  double taps = 0.0;
  for (int s = 1; s <= increments; ++s) {
    const MotionIncrement increment = steps.IncrementTo(s);
    taps += MotionKernel(increment, ErrorOf(increment, model.noise), model.grid.cell_m, model.grid.headings,
                         model.shape)
                .TapsACell();
  }
  const double seen = static_cast<double>(steps.observations.size()) / steps.size();
  return kAlways_ns +
         (in_cache ? kCached_ns : kUncached_ns) * (taps / std::max(1, increments) + kObservation * seen);
}

double CellsWhereLost(const RobotSteps& steps, const EStepModel& model, double table_cells) {
  int step = 0;
  while (step + 1 < steps.size() && steps.first_observation[step + 1] == 0) ++step;
  const double edge = table_cells + 2.0 * MotionMargin(model, steps, step) + 1.0;
  return edge * edge;
}

double WorkWhereLost(int count, const EStepModel& model) {
  double map = 0.0;
  for (const Layer& layer : model.perception->likelihood.layers) {
    map = std::max(map, static_cast<double>(layer.box.cells()));
  }
  return std::min(kStepsLost, static_cast<double>(count)) * map * model.grid.headings + count * kStepCells;
}

int SlicesFor(double work, double slice_work, int count) {
  if (work <= slice_work || count < 2) return 1;
  constexpr double kReserve = 1.5;
  return static_cast<int>(std::min<double>(count, std::ceil(kReserve * work / slice_work) + 2.0));
}

}  // namespace cairn::landmark_map
