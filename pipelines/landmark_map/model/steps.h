// From a log to the steps of one robot: coarse-grained time ([TBF98] section 5). A step stands where
// something was observed, or where the distance since the last one grew too long for the grid.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "pipelines/common/motion.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {

// What was seen at a step: a landmark at (x_m, y_m) from the robot, in the odometric frame's directions, so
// that a belief's layer c finds it at that vector turned by c * step. (0, 0) for a landmark at the robot
// itself.
struct Observation {
  std::int32_t type = 0;  // layer of the map; without identity: the number of identities plus its class
  double x_m = 0.0, y_m = 0.0;
  bool contact() const { return x_m == 0.0 && y_m == 0.0; }
  static void Fields(const auto& field) {
    field("type", &Observation::type);
    field("x_m", &Observation::x_m);
    field("y_m", &Observation::y_m);
  }
};

inline constexpr std::int64_t kMostSteps = 1 << 28;  // of a robot

// Arrays over the S steps of a robot; motion increment [s] leads to step s (motion increment 0 is empty).
struct RobotSteps {
  std::vector<double> time_s, odo_x_m, odo_y_m, odo_heading_rad, path_m,
      turn_rad;                                 // path and turn: of the motion increment
  std::vector<std::int32_t> first_observation;  // [S + 1] into `observations`
  std::vector<Observation> observations;
  std::vector<std::int32_t> row_observation;  // [O] the log's rows: which of `observations`, or -1: not used

  int size() const { return static_cast<int>(time_s.size()); }
  MotionIncrement IncrementTo(int step) const;
  // Way from the first step to each: [S].
  std::vector<double> DistanceTravelled() const;
  // The same steps with a heading drift taken off the odometry: motion increments and range-bearing
  // observations turn back by drift * distance travelled so far.
  RobotSteps WithoutDrift(double drift_rad_per_m) const;

  // As a task is handed them: with observations of so many layers of the map.
  // Throws InputError where the arrays do not fit each other, or are of more cells than a grid can have.
  static RobotSteps In(const Blob& blob, int layers, double cell_m);

  static void Fields(const auto& field) {
    field("time_s", &RobotSteps::time_s);
    field("odo_x_m", &RobotSteps::odo_x_m);
    field("odo_y_m", &RobotSteps::odo_y_m);
    field("odo_heading_rad", &RobotSteps::odo_heading_rad);
    field("path_m", &RobotSteps::path_m);
    field("turn_rad", &RobotSteps::turn_rad);
    field("first_observation", &RobotSteps::first_observation);
    field("observation", &RobotSteps::observations);
    field("row_observation", &RobotSteps::row_observation);
  }
};

// How finely time is cut.
struct StepRules {
  double max_increment_m;  // longer ways are split
  double frame_m;          // range-bearing observations within so much travelled …
  double frame_rad;        // … or turn are gathered into one step
  int types;               // number of identities; observations without one get this type, plus their class
  double until_s = std::numeric_limits<double>::infinity();  // later data are left out
  int classes = 1;  // of landmarks without identity; above 1 the robot has observations/type
};

// The steps of a robot. `robot`: the log's subtree robot/N/; `name`: the robot's, for messages. `shared` (may
// be nullptr): landmark types by which this robot finds itself in a map; its steps begin at the first that
// observes one. Rows later than rules.until_s are checked too, but not used.
// Throws InputError that names robot, row and reason where
// - Integrate does (common/odometry.h);
// - observations' arrays differ in length, a time is not a number or runs backwards;
// - an observation is of a landmark or type that the log does not list, has a range without a bearing or the
//   reverse, a negative or infinite one;
// - an observation lies more than a second outside the controls' times;
// - `shared` is given and the robot has seen none of these.
RobotSteps MakeSteps(const kinds::Log::Robot& robot, const std::string& name, const StepRules& rules,
                     const std::vector<bool>* shared);

}  // namespace cairn::landmark_map
