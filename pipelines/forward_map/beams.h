// The readings of range scans, and the cells that their beams meet.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "pipelines/common/beam_cells.h"
#include "pipelines/common/range_scans.h"
#include "pipelines/forward_map/forward_model.h"
#include "schema/kinds/log.h"

namespace cairn::forward_map {

struct BeamOfScan {
  std::size_t scan, beam;
  Pose from;
  double z_m;  // of one without echo, or beyond the model's z_max_m: that
  End end;     // of its axis
};

// Whether an echo from `z_m` away comes from beyond the box.
inline End EndOf(const GridBox& box, const Pose& from, double z_m) {
  const double x_m = from.x_m + z_m * std::cos(from.heading_rad),
               y_m = from.y_m + z_m * std::sin(from.heading_rad);
  return box.Holds(box.ColumnOf(x_m), box.RowOf(y_m)) ? End::kInMap : End::kBeyond;
}

// visit(BeamOfScan) for the readings of the scans [first, end) that are not held out; those without echo only
// where `no_echo` says so.
template <class Visit>
void ForEachReading(const RangeScans& scans, std::size_t first, std::size_t end, const GridBox& box,
                    const SensorModel& model, bool no_echo, Visit&& visit) {
  const auto range = scans.range_m.As<double>();
  const std::size_t beams = scans.beams.size();
  for (std::size_t s = first; s < end; ++s) {
    if (scans.held_out[s] != 0) continue;
    for (std::size_t b = 0; b < beams; ++b) {
      const double range_m = range[s * beams + b];
      const bool echo = kinds::IsEcho(range_m, model.z_max_m);
      if (!echo && !no_echo) continue;
      const Pose from = scans.BeamPose(s, b);
      visit(BeamOfScan{s, b, from, echo ? range_m : model.z_max_m,
                       echo ? EndOf(box, from, range_m) : End::kInMap});
    }
  }
}

// visit(cell, distance_m) for the cells that a beam meets up to `reach_m` and of which wanted(cell) is true:
// on a ray in order of distance, which is that of the middle of the part that lies in the cell; in a cone in
// no order, and that of the centre.
// [Thr01] section 3.1: d_ik, computed with ray tracing
template <class Wanted, class Visit>
void VisitBeam(const GridBox& box, const Pose& from, double opening_rad, double reach_m, Wanted&& wanted,
               Visit&& visit) {
  const auto within = [&](std::int64_t cell, double distance_m) {
    if (distance_m <= reach_m) visit(cell, distance_m);
  };
  if (opening_rad > 0) return WalkCone(box, from, opening_rad, reach_m, wanted, within);
  // Walked further than asked, so that no part that counts is cut short.
  WalkRay(box, from, reach_m + 2 * box.cell_m, [&](std::int64_t cell, double enter_m, double leave_m) {
    if (wanted(cell)) within(cell, 0.5 * (enter_m + leave_m));
  });
}

}  // namespace cairn::forward_map
