// The dominant orientation of walls: a histogram of edges' directions modulo pi / 2 ([DM98] section 3.2).
#pragma once

#include <numbers>
#include <optional>
#include <span>

#include "pipelines/local_map/grids/angle_histogram.h"
#include "pipelines/local_map/grids/decay.h"
#include "pipelines/local_map/grids/edge.h"

namespace cairn::local_map {

// How strong a peak must be to count.
struct PeakRule {
  double strength = 0.6;  // share of the weight within three of the eight bins
  double weight = 1;
};

class WallOrientation {
 public:
  static constexpr double kPeriodRad = std::numbers::pi / 2;

  // `kept`: the fraction of the histogram that is kept each scan.
  WallOrientation(double kept, PeakRule rule) : decay_(kept), rule_(rule) {}

  // The next scan, so many ticks after the last, with these edges. Each counts with the inverse variance of
  // its angle, 1/deg^2.
  void Add(std::span<const Edge> edges, std::int32_t ticks = kTicksPerScan);

  // Direction of the walls in [-pi / 4, pi / 4] and how strong it is; none without a strong peak.
  std::optional<AnglePeak> Dominant() const;
  const AngleHistogram& histogram() const { return histogram_; }

  // As if the frame's contents were turned counter-clockwise.
  void Turn(double angle_rad) { histogram_.Shift(angle_rad, kPeriodRad); }

 private:
  Decay decay_;
  PeakRule rule_;
  AngleHistogram histogram_;
};

}  // namespace cairn::local_map
