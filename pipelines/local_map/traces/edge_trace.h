// Edge traces ([DM98] section 4.1): one-dimensional maps of what lies left and right of a straight way.
//
// A trace's frame: z along the way, u to its left, metres, origin at the centre of a cell of the local frame.
// Feature z (an index) tells of the columns of cells whose z lies within half a cell of z * cell_m.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace cairn::local_map {

inline constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();

// Of possible values; unknown where no edge has been seen.
struct Interval {
  float low = kUnseen, high = kUnseen;

  bool known() const { return low == low; }
  float centre() const { return 0.5F * (low + high); }
  float width() const { return high - low; }
  void Include(float value) {
    if (!known() || value < low) low = value;
    if (!(value <= high)) high = value;
  }
};

// What lies on one side of the way.
struct Side {
  Interval angle_rad;   // directions of the edges, from the z axis, modulo pi; its centre in [-pi/2, pi/2]
  Interval distance_m;  // of the nearest edges from the z axis
  float cross_m = kUnseen;    // z of the edges that run across the way, from the feature's centre; NaN: none
  float cross_cells = 0;      // cells that those fill: as many witnesses as columns of a wall along the way
  float nearest_m = kUnseen;  // immediate traces: distance of the closest occupied cell; NaN: none
  std::uint8_t occupied = 0;  // whether cells of those edges were occupied

  bool known() const { return angle_rad.known(); }
};

struct Feature {
  Side left, right;
};

inline constexpr double kFarthest_m = 1e7;  // any two traces lie apart, which in cells is still an int

struct Position {
  double z_m = 0, u_m = 0;
  static void Fields(const auto& field) {
    field("z_m", &Position::z_m);
    field("u_m", &Position::u_m);
  }
};

class EdgeTrace {
 public:
  EdgeTrace() = default;
  // `capacity`: features that fit without allocation; a trace never grows beyond it.
  EdgeTrace(double cell_m, int first_z, std::size_t capacity);

  double cell_m() const { return cell_m_; }
  int first_z() const { return first_z_; }
  int end_z() const { return first_z_ + static_cast<int>(features_.size()); }
  const std::vector<Feature>& features() const { return features_; }
  const Feature* Find(int z) const {
    return z < first_z_ || z >= end_z() ? nullptr : &features_[static_cast<std::size_t>(z - first_z_)];
  }
  // Feature z, after growing the trace up to it, or back to it; null beyond its capacity.
  Feature* Touch(int z);
  // Empties it; memory stays.
  void Restart(double cell_m, int first_z);

 private:
  double cell_m_ = 0.15;
  int first_z_ = 0;
  std::size_t capacity_ = 0;
  std::vector<Feature> features_;
};

// The local grids in the format of a trace: what lies around the robot now.
struct ImmediateTrace {
  EdgeTrace trace;
  Position robot;  // in the trace's frame: less than a cell
};

// The same surroundings for one who drives back: z and u change their signs.
EdgeTrace Reversed(const EdgeTrace& trace);

// Features [first_z, end_z) only.
EdgeTrace Part(const EdgeTrace& trace, int first_z, int end_z);

}  // namespace cairn::local_map
