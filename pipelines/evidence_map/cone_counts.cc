#include "pipelines/evidence_map/cone_counts.h"

#include <algorithm>
#include <cmath>

#include "pipelines/common/beam_cells.h"

namespace cairn::evidence_map {
namespace {

double Fade(double part) { return std::max(0.0, 1 - part * part); }

std::int32_t Parts(double weight) {
  return std::max(1, static_cast<std::int32_t>(std::nearbyint(weight * kWhole)));
}

class Cone {
 public:
  Cone(const ConeModel& model, double opening_rad, double cell_m)
      : graded_(model.graded), half_opening_rad_(opening_rad / 2), half_wall_m_(model.wall_m + cell_m / 2) {}

  // To beyond which distance a reading of `range_m` says nothing.
  double Reach(double range_m, bool answered) const { return answered ? range_m + half_wall_m_ : range_m; }

  // What it says of the cell `at`, whose centre is `angle_rad` off the axis.
  void Add(const BeamCell& at, double angle_rad, double range_m, bool answered, std::size_t cell,
           Counts* counts) const {
    // [Thr01] section 2, p(m_xy | z) of a cone: at its range cells are occupied, before it they are free.
    const double off = Fade(std::min(1.0, std::abs(angle_rad) / half_opening_rad_));
    const double beyond_m = at.distance_m - range_m;
    if (answered && beyond_m >= -half_wall_m_) {
      counts->occupied[cell] += graded_ ? Parts(off * Fade(beyond_m / half_wall_m_)) : kWhole;
    } else {
      counts->free[cell] += graded_ ? Parts(off * Fade(at.distance_m / range_m)) : kWhole;
    }
  }

 private:
  bool graded_;
  double half_opening_rad_, half_wall_m_;
};

}  // namespace

Counts CountCones(const RangeScans& scans, const GridBox& grid, const ConeModel& model, bool use_no_return,
                  Progress& progress) {
  const Cone cone(model, scans.opening_rad, grid.cell_m);
  Counts counts = CountsFor(scans, grid, cone.Reach(0, true));
  const GridBox& box = counts.box;
  const auto range = scans.range_m.As<double>();
  const std::size_t beams = scans.beams.size();
  std::vector<BeamCell> cells;
  for (std::size_t s = 0; s < scans.scans(); ++s) {
    if (scans.held_out[s]) continue;
    for (std::size_t b = 0; b < beams; ++b) {
      progress.Tick();
      const double measured = range[s * beams + b];
      const bool answered = !std::isnan(measured);
      if (!answered && !use_no_return) continue;
      const double range_m = answered ? measured : scans.max_range_m;
      const Pose from = scans.BeamPose(s, b);
      BeamCells(grid, from, scans.opening_rad, cone.Reach(range_m, answered), &cells);
      for (const BeamCell& at : cells) {
        const std::int64_t i = at.cell % grid.columns, j = at.cell / grid.columns;
        const double dx = grid.CentreX(i) - from.x_m, dy = grid.CentreY(j) - from.y_m;
        const double angle = WrapAngle(std::atan2(dy, dx) - from.heading_rad);
        const std::int64_t in_window = (j - counts.first_row) * box.columns + i - counts.first_column;
        cone.Add(at, angle, range_m, answered, static_cast<std::size_t>(in_window), &counts);
      }
    }
  }
  return counts;
}

}  // namespace cairn::evidence_map
