#include "pipelines/local_map/grids/local_grids.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "schema/error.h"

namespace cairn::local_map {
namespace {

constexpr std::size_t kMostEdges = 64;

void Check(const Pose& pose, std::span<const RingScan> scans, const std::vector<SensorRing>& rings,
           double cell_m) {
  const double far_m = 1e6 * cell_m;
  if (!(std::abs(pose.x_m) < far_m && std::abs(pose.y_m) < far_m && std::abs(pose.heading_rad) < 1e6))
    throw InputError("local grids: a pose that is not of numbers, or a million cells from the start");
  if (scans.size() != rings.size())
    throw InputError("local grids: " + std::to_string(scans.size()) + " rings were read, there are " +
                     std::to_string(rings.size()));
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const std::size_t ranges = scans[r].range_m.size();
    if (ranges != 0 && ranges != rings[r].beams())
      throw InputError("local grids: ring " + std::to_string(r) + " gave " + std::to_string(ranges) +
                       " ranges, it has " + std::to_string(rings[r].beams()) + " beams");
    if (!std::isfinite(scans[r].turret_rad) || !std::isfinite(scans[r].time_s))
      throw InputError("local grids: the heading or time of ring " + std::to_string(r) + " is not a number");
  }
}

}  // namespace

LocalGrids::LocalGrids(const GridOptions& options, std::vector<SensorRing> rings)
    : options_(options),
      rings_(std::move(rings)),
      occupancy_(options.cell_m, static_cast<int>(options.half_cells), options.occupancy_kept,
                 options.occupied),
      edges_(options.cell_m, static_cast<int>(options.half_cells), options.edges_kept, options.edge_peak),
      orientation_(options.walls_kept, options.wall_peak),
      line_fit_(options.line, options.cell_m) {
  std::size_t most_hits = 0;
  for (const SensorRing& ring : rings_) most_hits += ring.sectors();
  hits_.resize(most_hits);
  ring_end_.resize(rings_.size());
  current_edges_.reserve(kMostEdges);
}

Alignment LocalGrids::Update(const Pose& odometry, std::span<const RingScan> scans) {
  Check(odometry, scans, rings_, options_.cell_m);
  const std::int32_t ticks = TicksUntil(scans);
  odometry_ = odometry;
  pose_ = Between(frame_, odometry);
  turned_rad_ = 0;
  occupancy_.MoveTo(pose_.x_m, pose_.y_m);
  edges_.MoveTo(pose_.x_m, pose_.y_m);
  occupancy_.NextScan(ticks);
  TakeHits(scans);
  FitLines();
  edges_.Add(current_edges_, ticks);
  orientation_.Add(current_edges_, ticks);
  return Align();
}

// Since the last scan, at least one; what rounding leaves over is remembered. The first scan stands for one
// of the paper's.
std::int32_t LocalGrids::TicksUntil(std::span<const RingScan> scans) {
  double time_s = scans.empty() ? time_s_ : scans[0].time_s;
  for (const RingScan& scan : scans) time_s = std::max(time_s, scan.time_s);
  if (begun_ && time_s < time_s_)
    throw InputError("local grids: time runs backwards, from " + std::to_string(time_s_) + " s to " +
                     std::to_string(time_s) + " s");
  if (begun_) owed_ticks_ = std::clamp(owed_ticks_, -1.0, 1.0) + std::min((time_s - time_s_) / kTickS, 1e6);
  begun_ = true;
  time_s_ = time_s;
  const auto ticks = static_cast<std::int32_t>(std::max(1.0, std::round(owed_ticks_)));
  owed_ticks_ -= ticks;
  return ticks;
}

void LocalGrids::TakeHits(std::span<const RingScan> scans) {
  std::size_t kept = 0;
  for (std::size_t r = 0; r < rings_.size(); ++r) {
    const std::size_t first = kept, count = rings_[r].Hits(pose_, scans[r], std::span(hits_).subspan(first));
    for (std::size_t k = first; k < first + count; ++k)
      if (occupancy_.Hit(hits_[k])) hits_[kept++] = hits_[k];
    ring_end_[r] = kept;
  }
  hit_count_ = kept;
}

// All hits are in the grid by now.
void LocalGrids::FitLines() {
  current_edges_.clear();
  std::size_t first = 0;
  for (std::size_t r = 0; r < rings_.size(); ++r) {
    // [DM98] figure 1, step 1: the hits of the last scan
    line_fit_.Find(hits().subspan(first, ring_end_[r] - first), rings_[r].closed(), occupancy_,
                   &current_edges_);
    first = ring_end_[r];
  }
}

Alignment LocalGrids::Align() {
  const auto peak = orientation_.Dominant();
  walls_.reset();
  const auto drifts_since = std::exchange(drifts_since_s_, std::nullopt);
  if (!peak) return Alignment::kNone;
  const double off = peak->angle_rad;
  const double angle = frame_.heading_rad + off;
  last_walls_rad_ += ModuloAngle(angle - last_walls_rad_, WallOrientation::kPeriodRad);
  walls_ = {last_walls_rad_, peak->strength};
  if (!locked_) {
    locked_ = true;
    // [DM98] section 3.2: the grid is turned to where the walls lie along its axes.
    if (options_.align) Turn(off);
    return Alignment::kLocked;
  }
  const double off_deg = std::abs(DegOf(off));
  // [DM98] section 3.4, footnote 3: between 5.5 and 11 degrees
  if (off_deg > kMaxRealignDeg)
    return std::exchange(other_area_, true) ? Alignment::kNone : Alignment::kOtherArea;
  const bool was_other = std::exchange(other_area_, false);
  if (off_deg >= kMinRealignDeg) {
    drifts_since_s_ = drifts_since.value_or(time_s_);
    if (time_s_ - *drifts_since_s_ >= kSteadyS && options_.align) {
      Turn(off);
      return Alignment::kRealigned;
    }
  }
  return was_other ? Alignment::kBack : Alignment::kNone;
}

void LocalGrids::Turn(double angle_rad) {
  turned_rad_ = angle_rad;
  occupancy_.Turn(-angle_rad);
  edges_.Turn(-angle_rad);
  orientation_.Turn(-angle_rad);
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  for (Point& hit : hits_) {
    const double x = hit.x_m - pose_.x_m, y = hit.y_m - pose_.y_m;
    hit = {pose_.x_m + c * x + s * y, pose_.y_m - s * x + c * y};
  }
  pose_.heading_rad -= angle_rad;
  frame_ = Compose(odometry_, Between(pose_, {}));
  FitLines();
}

}  // namespace cairn::local_map
