// What there is to draw of a landmark map, in metres, in the result's own frame.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/grid.h"
#include "datasets/report/drawing/axes.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets::report {

struct Path {
  std::string robot;
  std::size_t index = 0;  // of the robot: its colour
  std::vector<Point> points;
  std::vector<double> time_s = {};  // of each point; empty where it is not known
  // Points before which nothing is known of the path: no line leads to them.
  std::vector<std::size_t> breaks = {};
};

// The stretches between a path's breaks. One of a single point is a place, and no way.
std::vector<Path> Pieces(const Path& path);

// Where the time to the one before is longer than a second and four times what is usual among them: a
// receiver that lost its satellites, a recording that paused.
std::vector<std::size_t> BreaksOf(std::span<const double> time_s);

struct EllipseM {
  Point centre;
  double major_m = 0, minor_m = 0;  // semi-axes of the 95% region
  double angle_rad = 0;             // of the major one, from x
};

struct MapLandmark {
  Point at;
  EllipseM ellipse;
  double count = 0;               // expected observations
  std::string name;               // its label (landmark_labels.h)
  bool identified = false;        // the name is its identity's
  bool spurious = false;          // an evaluation found no true one near it
  std::optional<double> error_m;  // to its true one
  std::string moved = {};         // ", was moved between 12.0 s and 15.5 s"; empty: it stood still
};

struct Grid {
  Point origin;  // lower left corner
  double cell_m = 1;
  std::int64_t columns = 0, rows = 0;
  std::vector<double> probability;  // [rows][columns], the largest over the landmark types
};

struct Scene {
  std::vector<Path> paths;           // most likely poses
  std::vector<Path> odometry;        // dead reckoning from each path's first pose; empty without a log
  std::vector<Path> odometry_below;  // the same, to be drawn on the map itself
  std::vector<Path> odometry_marks;  // where it puts the robot at each observation without a range
  std::vector<Path> truth_paths;     // empty without an evaluation
  std::vector<MapLandmark> landmarks;
  std::vector<Point> truth_landmarks;                // those that were observed
  std::vector<std::pair<Point, Point>> error_lines;  // (extracted, true), matched
  std::vector<std::pair<Point, Point>> truth_walls;  // both ends of each
  std::vector<Point> edges;                          // where walls were met
  struct Loop {
    Point from, to;
    bool used = true;  // the path follows it
  };
  std::vector<Loop> loops;
  std::optional<Grid> grid;
  std::vector<std::vector<Point>> rounds;  // the landmarks of each map that came before this one
};

// Names of landmarks that are their numbers tell people nothing once they are many: then they are left out.
inline constexpr std::size_t kMostNumbers = 60;

// Those to be written on a map; the heavier, the more often observed. Their places are left to the caller.
std::vector<std::size_t> NamedLandmarks(const Scene& scene);

// "robot 3" for a robot that is called 3.
std::string RobotTitle(const std::string& name);

// `log` and `evaluation` may be null; truth is drawn where both are there, laid over the result by the
// inverse of the evaluation's alignment.
// Throws InputError where the result lacks what a landmark_map has.
Scene MakeScene(const Blob& result, const Blob* log, const Evaluation* evaluation);

// What lies on a grid map: where each robot was when it scanned (of its sensor of most scans) and, with both
// `log` and `evaluation`, the true walls.
Scene GridSceneOf(const Blob& map, const Blob* log, const GridEvaluation* evaluation);

// Round the paths, landmarks and true landmarks; with `with_odometry` the dead reckoning too. At least 1 m
// wide.
// Throws InputError where a position is not a number, or farther than any place on earth.
Box BoundsOf(const Scene& scene, bool with_odometry);

// Semi-axes of the region that holds 95% of a normal distribution of this covariance (row-major, m2):
// chi-squared with two degrees of freedom, 5.991.
EllipseM EllipseOf(Point centre, const std::array<double, 4>& covariance_m2);

}  // namespace cairn::datasets::report
