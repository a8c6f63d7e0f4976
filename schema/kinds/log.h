// schema/FORMAT.md, `log`: what robots did and saw.
#pragma once

#include "schema/kinds/poses.h"

namespace cairn::kinds {

// Whether a range sensor met something: NaN says that it did not, and so does the largest range that it
// gives, which f32 and f64 may round apart.
inline constexpr double kReachRounding = 1e-6;
inline bool IsEcho(double range_m, double max_range_m) {
  return range_m < max_range_m * (1 - kReachRounding);
}

struct Log {
  struct Odometry {
    Column<double> time_s, turn_rad, forward_m;
    static void Fields(const auto& field) {
      field(Needed("time_s", "C", Rising()), &Odometry::time_s);
      field(Needed("turn_rad", "C", Finite()), &Odometry::turn_rad);
      field(Needed("forward_m", "C", Position()), &Odometry::forward_m);
    }
  };
  struct Observations {
    Column<double> time_s, range_m, bearing_rad;
    Column<std::int32_t> landmark, type;
    static void Fields(const auto& field) {
      field(Needed("time_s", "O", Rising()), &Observations::time_s);
      field(Needed("landmark", "O", IndexInto("landmarks").OrNone()), &Observations::landmark);
      field(Needed("range_m", "O", Positive().OrNan()), &Observations::range_m);
      field(Needed("bearing_rad", "O", Finite().OrNan()), &Observations::bearing_rad);
      field({"type", "O", IndexInto("types").OrNone()}, &Observations::type);
    }
  };
  struct RobotObservations {  // of other robots
    Column<double> time_s, range_m, bearing_rad;
    Column<std::int32_t> robot;
    static void Fields(const auto& field) {
      field(Needed("time_s", "S", Rising()), &RobotObservations::time_s);
      field(Needed("robot", "S", IndexInto("robots")), &RobotObservations::robot);
      field(Needed("range_m", "S", Positive().OrNan()), &RobotObservations::range_m);
      field(Needed("bearing_rad", "S", Finite().OrNan()), &RobotObservations::bearing_rad);
    }
  };
  struct RangeSensor {
    std::string sensor;
    Column<double> time_s, range_m, beam_x_m, beam_y_m, beam_heading_rad, turret_rad, opening_rad,
        max_range_m;
    Column<float> intensity;
    static void Fields(const auto& field) {
      field(Needed("time_s", "K", Rising()), &RangeSensor::time_s);
      field(Needed("range_m", "K,B", NotNegative().OrNan()), &RangeSensor::range_m);
      field(Needed("beam_x_m", "B", Position()), &RangeSensor::beam_x_m);
      field(Needed("beam_y_m", "B", Position()), &RangeSensor::beam_y_m);
      field(Needed("beam_heading_rad", "B", Angle()), &RangeSensor::beam_heading_rad);
      field({"intensity", "K,B", Free()}, &RangeSensor::intensity);
      field({"turret_rad", "K", Angle()}, &RangeSensor::turret_rad);
      field(Needed("opening_rad", "", Between(0, 3.15)), &RangeSensor::opening_rad);
      field(Needed("max_range_m", "", Reach()), &RangeSensor::max_range_m);
    }
  };
  struct Robot {
    Odometry odometry;
    Observations observations;
    RobotObservations robot_observations;
    Column<double> hints_time_s;
    PoseTable poses;
    PerSensor<RangeSensor> sensors;
    bool HasControls() const { return odometry.time_s && !odometry.time_s.empty(); }
    static void Fields(const auto& field) {
      field("odometry", &Robot::odometry);
      field("observations", &Robot::observations);
      field("robot_observations", &Robot::robot_observations);
      field({"hints/time_s", "H", Rising()}, &Robot::hints_time_s);
      field("poses", &Robot::poses);
      field("SENSOR", &Robot::sensors);
    }
  };
  // Noise parameters, as a data sheet gives them.
  struct Noise {
    Column<double> heading_drift_rad_per_m, heading_walk_rad_per_sqrt_m, forward_ratio, turn_ratio, contact_m,
        range_m, bearing_rad, false_ratio, miss_ratio, type_confusion, sonar_m;
    static void Fields(const auto& field) {
      field({"heading_drift_rad_per_m", "", NotNegative()}, &Noise::heading_drift_rad_per_m);
      field({"heading_walk_rad_per_sqrt_m", "", NotNegative()}, &Noise::heading_walk_rad_per_sqrt_m);
      field({"forward_ratio", "", NotNegative()}, &Noise::forward_ratio);
      field({"turn_ratio", "", NotNegative()}, &Noise::turn_ratio);
      field({"contact_m", "", NotNegative()}, &Noise::contact_m);
      field({"range_m", "", NotNegative()}, &Noise::range_m);
      field({"bearing_rad", "", NotNegative()}, &Noise::bearing_rad);
      field({"false_ratio", "", Share()}, &Noise::false_ratio);
      field({"miss_ratio", "", Share()}, &Noise::miss_ratio);
      field({"type_confusion", "T,T", Share()}, &Noise::type_confusion);
      field({"sonar_m", "", NotNegative()}, &Noise::sonar_m);
    }
  };
  struct TrueSensor {
    std::string sensor;
    Column<std::uint8_t> cause;
    static void Fields(const auto& field) { field({"cause", "K,B", Between(0, 4)}, &TrueSensor::cause); }
  };
  struct TrueRobot {
    PoseTable poses;
    Column<std::int32_t> landmark;  // of each observation
    Column<double> walls_time_s, walls_angle_rad;
    PerSensor<TrueSensor> sensors;
    static void Fields(const auto& field) {
      field({"poses", "Q"}, &TrueRobot::poses);
      field({"observations/landmark", "O", IndexInto("truth/landmarks/x_m").OrNone()}, &TrueRobot::landmark);
      field(Needed("walls/time_s", "A", Rising()), &TrueRobot::walls_time_s);
      field(Needed("walls/angle_rad", "A", Finite()), &TrueRobot::walls_angle_rad);
      field("SENSOR", &TrueRobot::sensors);
    }
  };
  struct Landmarks {
    Texts name;
    Column<double> x_m, y_m;
    Column<std::int32_t> type;
    static void Fields(const auto& field) {
      field({"name", "M"}, &Landmarks::name);
      field(Needed("x_m", "M", Position()), &Landmarks::x_m);
      field(Needed("y_m", "M", Position()), &Landmarks::y_m);
      field({"type", "M", IndexInto("types").OrNone()}, &Landmarks::type);
    }
  };
  struct Truth {
    std::vector<TrueRobot> robot;
    Landmarks landmarks;
    Column<double> walls_x_m, walls_y_m, walls_from_s, walls_until_s, doors_x_m, doors_y_m, person_time_s,
        person_x_m, person_y_m;
    Column<std::uint8_t> walls_smooth, doors_open;
    static void Fields(const auto& field) {
      field("robot", &Truth::robot);
      field("landmarks", &Truth::landmarks);
      field(Needed("walls/x_m", "W,2", Position()), &Truth::walls_x_m);
      field(Needed("walls/y_m", "W,2", Position()), &Truth::walls_y_m);
      field({"walls/smooth", "W", YesNo()}, &Truth::walls_smooth);
      field({"walls/from_s", "W", Free()}, &Truth::walls_from_s);
      field({"walls/until_s", "W", Free()}, &Truth::walls_until_s);
      field(Needed("doors/x_m", "D,2", Position()), &Truth::doors_x_m);
      field(Needed("doors/y_m", "D,2", Position()), &Truth::doors_y_m);
      field(Needed("doors/open", "D", YesNo()), &Truth::doors_open);
      field(Needed("person/time_s", "E", Rising()), &Truth::person_time_s);
      field(Needed("person/x_m", "E", Position()), &Truth::person_x_m);
      field(Needed("person/y_m", "E", Position()), &Truth::person_y_m);
    }
  };

  Texts robots, landmarks, types;
  std::vector<Robot> robot;
  Noise noise;
  Column<double> max_range_m, field_of_view_rad;
  Column<std::uint8_t> units_are_right;
  Truth truth;

  static void Fields(const auto& field) {
    field({"robots", "R"}, &Log::robots);
    field("robot", &Log::robot);
    field({"landmarks", "L"}, &Log::landmarks);
    field({"types", "T"}, &Log::types);
    field("noise", &Log::noise);
    field({"sensor/max_range_m", "", NotNegative()}, &Log::max_range_m);
    field({"sensor/field_of_view_rad", "", NotNegative()}, &Log::field_of_view_rad);
    field({"units_are_right", "", YesNo()}, &Log::units_are_right);
    field("truth", &Log::truth);
  }
};

}  // namespace cairn::kinds
