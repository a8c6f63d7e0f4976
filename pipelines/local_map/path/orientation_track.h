// Which way the walls lie along a run, in the frame of its dead reckoning: what grids saw of them, scan by
// scan, chained into one continuous angle. What the walls' angle drifts by is what the odometric heading
// does.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <vector>

#include "pipelines/local_map/path/runs.h"

namespace cairn::local_map {

struct OrientationOptions {
  double walk_rad_per_sqrt_m = 0.1;  // sd of the heading's random walk, before the log has told its own
  double turn_ratio = 0.1;           // sd of a turn's error, a fraction of the turn
  double seen_rad = 0.035;           // sd of one sight of the walls' orientation
  double other_rad = 0.192;          // 11 degrees: edges that differ by more are of other things
};

// Directions of edges modulo pi / 2, metres of edge in each degree.
inline constexpr std::size_t kBins = 90;
inline constexpr double kBin_rad = std::numbers::pi / 2 / kBins;
using EdgeHistogram = std::array<float, kBins>;
// Shares `length_m` among the two nearest bins, whose middles are at k kBin_rad.
void AddEdge(double angle_rad, double length_m, EdgeHistogram* histogram);

// The same edges in a frame that is turned clockwise by so much.
EdgeHistogram Turned(const EdgeHistogram& histogram, double angle_rad);

struct OrientationSight {
  double path_m = 0;        // distance travelled so far
  double heading_rad = 0;   // by odometry, not wrapped
  EdgeHistogram edges_m{};  // what this scan showed
  bool begins = false;      // the first scan after a jump, at which odometry's heading is lost
};

struct Orientation {
  double angle_rad = 0;  // continuous, in [-pi/4, pi/4] where the track begins
  double sd_rad = 0;
  double strength = 0;  // share of this scan's edges that lie as the walls do
  bool other = false;   // most of them lie otherwise
};

struct OrientationTrack {
  std::vector<Orientation> at;  // of each sight
  bool seen = false;            // walls were, at all
  double drift_rad_per_m = 0;   // of odometry's heading, and
  double turn_scale = 0;        // what it makes too much of turns, both as the track showed them
  double walk_rad_per_sqrt_m = 0;
};

// First the most likely sequence of orientations on a circle of half degrees, places 0.3 m apart (Viterbi),
// which finds its way through areas that are oriented otherwise; odometry's own errors are estimated from it
// and the search repeated. Then a smoother (Rauch, Tung, Striebel 1965) of each scan's edges that lie within
// other_rad of it.
OrientationTrack TrackOrientation(const std::vector<OrientationSight>& sights,
                                  const OrientationOptions& options);

// Takes the walls' orientation out of the scans' headings, so that walls lie along the axes, and turns each
// way between two scans likewise, and makes it `scale` times as long. `walls`: of each scan, in the frame
// of its pose.
void Correct(const OrientationTrack& walls, double scale, std::vector<Scan>* scans);

}  // namespace cairn::local_map
