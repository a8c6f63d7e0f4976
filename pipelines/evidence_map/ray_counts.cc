#include "pipelines/evidence_map/ray_counts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipelines/common/beam_cells.h"

namespace cairn::evidence_map {
namespace {

// Few bytes a cell, so that more of the map stays in the cache; emptied before one may be full.
using Few = std::uint16_t;
constexpr std::size_t kMostRays = std::numeric_limits<Few>::max();

// In cells of the grid, (0, 0) its corner.
struct Point {
  double x, y;
};

struct Ray {
  Point from, to;
  double slope;  // of the shorter side by the longer
  bool steep;    // y is the longer
};

class RayCounter {
 public:
  explicit RayCounter(Counts* counts)
      : counts_(counts),
        columns_(counts->box.columns),
        corner_(counts->first_row * columns_ + counts->first_column),
        free_(counts->free.size()) {}

  // Both ends lie in the grid. The middle of the first column may be met outside by half a cell: there the
  // window has a cell more.
  void Add(const Ray& ray, bool hit) {
    if (++rays_ == kMostRays) Empty();
    if (ray.steep) {
      Step<false>(ray.from.y, ray.from.x, ray.to.y, ray.slope);
    } else {
      Step<true>(ray.from.x, ray.from.y, ray.to.x, ray.slope);
    }
    const auto column = static_cast<std::int64_t>(ray.to.x), row = static_cast<std::int64_t>(ray.to.y);
    // [Thr01] section 2, p(m_xy | z) of a ray: where it ends is occupied, the cells before it are free.
    ++(hit ? counts_->occupied : counts_->free)[static_cast<std::size_t>(row * columns_ + column - corner_)];
  }

  void Empty() {
    std::int32_t* const to = counts_->free.data();
    for (std::size_t k = 0; k < free_.size(); ++k) {
      to[k] += free_[k];
      free_[k] = 0;
    }
    rays_ = 0;
  }

 private:
  // Along the longer side u from `u0` to before the cell of `u1`; w is the other side, in fixed point with 32
  // bits below the cell.
  template <bool kAlongRows>
  void Step(double u0, double w0, double u1, double slope) {
    const auto first = static_cast<std::int64_t>(u0), last = static_cast<std::int64_t>(u1);
    const std::int64_t way = last >= first ? 1 : -1;
    constexpr double kOne = 4294967296.0;
    const double middle = w0 + (static_cast<double>(first) + 0.5 - u0) * slope;
    auto w = static_cast<std::int64_t>(middle * kOne);
    const auto step = static_cast<std::int64_t>(slope * kOne) * way;
    const std::int64_t along = kAlongRows ? 1 : columns_, across = kAlongRows ? columns_ : 1;
    Few* column = free_.data() + (first * along - corner_);
#pragma GCC unroll 4
    for (std::int64_t n = (last - first) * way; n > 0; --n) {
      ++column[(w >> 32) * across];
      column += way * along;
      w += step;
    }
  }

  Counts* counts_;
  std::int64_t columns_, corner_;  // of the window; where its corner lies in the grid, in its columns
  std::vector<Few> free_;
  std::size_t rays_ = 0;  // since it was empty
};

// The rays of a scan. What does not depend on the range is made for all beams at once, in loops without
// branches.
class Rays {
 public:
  Rays(const RangeScans& scans, const GridBox& grid) : scans_(scans), grid_(grid) {
    for (const Pose& beam : scans.beams) {
      beam_x_.push_back(beam.x_m);
      beam_y_.push_back(beam.y_m);
      beam_c_.push_back(std::cos(beam.heading_rad));
      beam_s_.push_back(std::sin(beam.heading_rad));
    }
    for (auto* column : {&x_, &y_, &ux_, &uy_, &slope_}) column->resize(scans.beams.size());
  }

  void StartScan(std::size_t scan) {
    const Pose pose = scans_.MountPose(scan);
    const double per_m = 1 / grid_.cell_m;
    const double c = std::cos(pose.heading_rad) * per_m, s = std::sin(pose.heading_rad) * per_m;
    const double x = (pose.x_m - grid_.origin_x_m) * per_m, y = (pose.y_m - grid_.origin_y_m) * per_m;
    for (std::size_t b = 0; b < x_.size(); ++b) {
      x_[b] = x + c * beam_x_[b] - s * beam_y_[b];
      y_[b] = y + s * beam_x_[b] + c * beam_y_[b];
      const double ux = c * beam_c_[b] - s * beam_s_[b], uy = s * beam_c_[b] + c * beam_s_[b];
      const bool steep = std::abs(ux) < std::abs(uy);
      slope_[b] = (steep ? ux : uy) / (steep ? uy : ux);
      ux_[b] = ux;
      uy_[b] = uy;
    }
  }

  Ray Of(std::size_t b, double first_m, double last_m) const {
    return {At(b, first_m), At(b, last_m), slope_[b], std::abs(ux_[b]) < std::abs(uy_[b])};
  }

 private:
  Point At(std::size_t b, double range_m) const {
    return {x_[b] + range_m * ux_[b], y_[b] + range_m * uy_[b]};
  }

  const RangeScans& scans_;
  const GridBox& grid_;
  std::vector<double> beam_x_, beam_y_, beam_c_, beam_s_;  // [B] where it begins, its direction, on the robot
  std::vector<double> x_, y_, ux_, uy_, slope_;            // [B] in cells of the grid; a meter of the beam
};

bool Inside(const Point& p, const GridBox& grid) {
  return p.x >= 0 && p.y >= 0 && p.x < static_cast<double>(grid.columns) &&
         p.y < static_cast<double>(grid.rows);
}

// Cut to the grid; false: nothing is left. A point on the border belongs to the cell beyond, so a cut ends a
// little inside.
bool Cut(const GridBox& grid, const Rays& rays, std::size_t b, const RayPart& part, double length_m,
         Ray* ray) {
  const double little_m = 1e-6 * grid.cell_m;
  const double first_m = part.first_m > 0 ? part.first_m + little_m : 0;
  const double last_m = part.last_m < length_m ? part.last_m - little_m : length_m;
  if (!(first_m < last_m)) return false;
  *ray = rays.Of(b, first_m, last_m);
  return Inside(ray->from, grid) && Inside(ray->to, grid);  // or it touches a corner
}

}  // namespace

Counts CountRays(const RangeScans& scans, const GridBox& grid, bool use_no_return, Progress& progress) {
  Counts counts = CountsFor(scans, grid, 0);
  RayCounter counter(&counts);
  Rays rays(scans, grid);
  const auto range = scans.range_m.As<double>();
  const std::size_t beams = scans.beams.size();
  for (std::size_t s = 0; s < scans.scans(); ++s) {
    if (scans.held_out[s]) continue;
    progress.Tick();
    rays.StartScan(s);
    for (std::size_t b = 0; b < beams; ++b) {
      const double measured = range[s * beams + b];
      bool hit = !std::isnan(measured);
      if (!hit && !use_no_return) continue;
      const double length_m = hit ? measured : scans.max_range_m;
      Ray ray = rays.Of(b, 0, length_m);
      if (!Inside(ray.from, grid) || !Inside(ray.to, grid)) {
        const RayPart part = ClipRay(grid, scans.BeamPose(s, b), length_m);
        if (!Cut(grid, rays, b, part, length_m, &ray)) continue;
        hit = hit && part.last_m >= length_m;
      }
      counter.Add(ray, hit);
    }
  }
  counter.Empty();
  return counts;
}

}  // namespace cairn::evidence_map
