// Landmarks in one scan of a laser: posts by their shape, reflectors by how bright they are. No files, no
// logs.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets {

// Of values that there are.
double MedianOf(std::vector<double> values);

// A laser's beams, counter-clockwise. Throws InputError where they are no fan: fewer than three, not from one
// place, not one after the other.
class BeamFan {
 public:
  BeamFan(std::span<const double> x_m, std::span<const double> y_m, std::span<const double> heading_rad);

  std::size_t size() const { return angle_rad_.size(); }
  double step_rad() const { return step_rad_; }                    // from beam to beam, in the middle
  double angle_rad(std::size_t i) const { return angle_rad_[i]; }  // on the robot; beyond a turn at the end
  Point at() const { return at_; }                                 // where they begin, on the robot
  // Beams as they are stored, in the fan's order.
  std::vector<double> Ordered(std::span<const double> stored) const;
  // Whether the sensor looks between beam i and the next one; of the last one, whether it looks all round.
  bool HasNext(std::size_t i) const { return has_next_[i]; }

 private:
  Point at_;
  bool reversed_ = false;
  double step_rad_ = 0;
  std::vector<double> angle_rad_;
  std::vector<bool> has_next_;
};

struct PostLimits {
  double least_m = 0.05, most_m = 0.6;  // of the diameter, or a reflector's width
  double reach_m = 0;                   // the sensor's: beyond it nothing is known
  double sigma_m = 0.03;                // of a range
};

// A post that was seen, from where the beams begin: its middle, and how far off that may be.
struct Post {
  double range_m = 0, bearing_rad = 0, radius_m = 0;
  double range_sigma_m = 0, bearing_sigma_rad = 0;
  std::size_t beams = 0;
  double squares_m2 = 0;  // what its ranges and the fit differ by, squared and added up
};

// What stands nearer than all beside it, is as wide as a post, and fits a circle: the trunks of J. Guivant,
// F. Masson, E. Nebot, Simultaneous localization and map building using natural features and absolute
// information, Robotics and Autonomous Systems 40, 2002: beams of like ranges between two jumps, as wide as
// their angle at that range. The circle is fitted here to ranges and to both edges, which lie half a beam
// beyond the last that met it, give or take. What reaches the edge of what is seen, stands before something
// less than half of `most_m` behind it, or is partly hidden by what is nearer, is none. NaN: nothing within
// reach.
std::vector<Post> FindPosts(const BeamFan& fan, std::span<const double> range_m, const PostLimits& limits);

// How bright things are at each distance, of a whole log; what is brighter by far is a reflector.
class Brightness {
 public:
  void Add(double range_m, float intensity);
  void Finish();  // before At
  double LeastOfReflectors(double range_m) const;

 private:
  static constexpr double kBin_m = 0.5;
  static std::size_t BinOf(double range_m);
  std::vector<std::vector<float>> seen_;  // by distance
  std::vector<double> least_;
};

// Beams that are at least as bright as `least_bright` says of their range, side by side at one distance, as
// wide as a reflector, and not partly hidden. Its middle is that of the surface, or of the post that bears it
// where it stands alone.
std::vector<Post> FindReflectors(const BeamFan& fan, std::span<const double> range_m,
                                 std::span<const double> intensity, const Brightness& brightness,
                                 const PostLimits& limits);

}  // namespace cairn::datasets
