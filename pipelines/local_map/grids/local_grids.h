// The four sensory resources of [DM98], updated by one call a scan: hits, occupancy grid, dominant wall
// orientation, edge grid.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pipelines/local_map/grids/edge_grid.h"
#include "pipelines/local_map/grids/grid_options.h"
#include "pipelines/local_map/grids/line_fit.h"
#include "pipelines/local_map/grids/occupancy_grid.h"
#include "pipelines/local_map/grids/ring.h"
#include "pipelines/local_map/grids/wall_orientation.h"
#include "schema/geometry.h"

namespace cairn::local_map {

// Direction of the walls in the odometric frame: one of the four at square angles, that which is nearest to
// the one before, so that it is continuous and not bounded.
struct WallEstimate {
  double angle_rad = 0;
  double strength = 0;  // of the peak, from 3/8 (none) to 1
};

// What a scan did to the frame.
enum class Alignment {
  kNone,
  kLocked,     // the first time: the frame was turned along the walls
  kRealigned,  // the walls had drifted by 5.5 to 11 degrees for some time: the frame was turned after them
  kOtherArea,  // the walls differ by more: this area is oriented in a different way; nothing was turned
  kBack,       // the walls lie as they did before that area
};

class LocalGrids {
 public:
  // From these deviations on, and up to these, the frame is turned after the walls ([DM98] section 3.4,
  // footnote 3).
  static constexpr double kMinRealignDeg = 5.5, kMaxRealignDeg = 11;
  // For so long without a break they deviate so: between areas of different orientation the histogram passes
  // through all angles.
  static constexpr double kSteadyS = 5;

  LocalGrids(const GridOptions& options, std::vector<SensorRing> rings);

  // One scan of all rings, in the order of the constructor, at the robot's pose in the odometric frame. Does
  // not allocate.
  // Throws InputError where
  // - the pose is not of numbers, or lies beyond a million cells;
  // - the numbers of rings or of their ranges are others than the constructor's;
  // - a ring's heading or time is not a number, or time runs backwards.
  Alignment Update(const Pose& odometry, std::span<const RingScan> scans);

  // The robot in the local frame. When the frame is turned, it is about the robot: only the heading changes.
  const Pose& pose() const { return pose_; }
  // The local frame in the odometric one, and its heading: walls lie along its axes once locked.
  const Pose& frame() const { return frame_; }
  double frame_rad() const { return frame_.heading_rad; }

  bool locked() const { return locked_; }
  bool other_area() const { return other_area_; }
  // Radians by which this scan turned the frame.
  double turned_rad() const { return turned_rad_; }
  // None while no direction is dominant.
  std::optional<WallEstimate> walls_rad() const { return walls_; }

  const OccupancyGrid& occupancy() const { return occupancy_; }
  const EdgeGrid& edges() const { return edges_; }
  std::span<const Edge> current_edges() const { return current_edges_; }
  std::span<const Point> hits() const { return {hits_.data(), hit_count_}; }  // of this scan
  const AngleHistogram& wall_histogram() const { return orientation_.histogram(); }

 private:
  std::int32_t TicksUntil(std::span<const RingScan> scans);
  void TakeHits(std::span<const RingScan> scans);
  void FitLines();
  Alignment Align();
  void Turn(double angle_rad);

  GridOptions options_;
  std::vector<SensorRing> rings_;
  OccupancyGrid occupancy_;
  EdgeGrid edges_;
  WallOrientation orientation_;
  LineFit line_fit_;
  Pose odometry_, frame_, pose_;
  std::vector<Point> hits_;
  std::size_t hit_count_ = 0;
  std::vector<std::size_t> ring_end_;  // of each ring's hits
  std::vector<Edge> current_edges_;
  std::optional<WallEstimate> walls_;
  bool locked_ = false, other_area_ = false;
  std::optional<double> drifts_since_s_;
  double time_s_ = 0, owed_ticks_ = kTicksPerScan;
  bool begun_ = false;
  double turned_rad_ = 0, last_walls_rad_ = 0;
};

}  // namespace cairn::local_map
