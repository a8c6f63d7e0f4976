#include "schema/kinds/tables.h"

namespace cairn {
namespace {

constexpr ArraySpec kLog[] = {
    {"robots", "R", text},
    {"robot/N/odometry/time_s", "C", f64, Rising()},
    {"robot/N/odometry/turn_rad", "C", f64, Finite()},
    {"robot/N/odometry/forward_m", "C", f64, Position()},
    {"robot/N/observations/time_s", "O", f64, Rising()},
    {"robot/N/observations/landmark", "O", i32, IndexInto("landmarks").OrNone()},
    {"robot/N/observations/range_m", "O", f64, NotNegative().OrNan()},
    {"robot/N/observations/bearing_rad", "O", f64, Finite().OrNan()},
    {"robot/N/observations/type", "O", i32, IndexInto("types").OrNone()},
    {"landmarks", "L", text},
    {"types", "T", text},
    {"robot/N/robot_observations/time_s", "S", f64, Rising()},
    {"robot/N/robot_observations/robot", "S", i32, IndexInto("robots")},
    {"robot/N/robot_observations/range_m", "S", f64, NotNegative().OrNan()},
    {"robot/N/robot_observations/bearing_rad", "S", f64, Finite().OrNan()},
    {"robot/N/hints/time_s", "H", f64, Rising()},
    {"noise/heading_drift_rad_per_m", "", f64, NotNegative()},
    {"noise/heading_walk_rad_per_sqrt_m", "", f64, NotNegative()},
    {"noise/forward_ratio", "", f64, NotNegative()},
    {"noise/turn_ratio", "", f64, NotNegative()},
    {"noise/contact_m", "", f64, NotNegative()},
    {"noise/range_m", "", f64, NotNegative()},
    {"noise/bearing_rad", "", f64, NotNegative()},
    {"noise/false_ratio", "", f64, Share()},
    {"noise/miss_ratio", "", f64, Share()},
    {"noise/type_confusion", "T,T", f64, Share()},
    {"noise/sonar_m", "", f64, NotNegative()},
    {"sensor/max_range_m", "", f64, NotNegative()},
    {"sensor/field_of_view_rad", "", f64, NotNegative()},
    {"units_are_right", "", u8, YesNo()},
    {"robot/N/poses/time_s", "P", f64, Rising()},
    {"robot/N/poses/x_m", "P", f64, Position()},
    {"robot/N/poses/y_m", "P", f64, Position()},
    {"robot/N/poses/heading_rad", "P", f64, Finite()},
    {"truth/robot/N/poses/time_s", "Q", f64, Rising()},
    {"truth/robot/N/poses/x_m", "Q", f64, Position()},
    {"truth/robot/N/poses/y_m", "Q", f64, Position()},
    {"truth/robot/N/poses/heading_rad", "Q", f64, Finite()},
    {"truth/robot/N/observations/landmark", "O", i32, IndexInto("truth/landmarks/x_m").OrNone()},
    {"truth/landmarks/name", "M", text},
    {"truth/landmarks/x_m", "M", f64, Position()},
    {"truth/landmarks/y_m", "M", f64, Position()},
    {"truth/landmarks/type", "M", i32, IndexInto("types").OrNone()},
    {"truth/walls/x_m", "W,2", f64, Position()},
    {"truth/walls/y_m", "W,2", f64, Position()},
    {"truth/walls/smooth", "W", u8, YesNo()},
    {"truth/walls/from_s", "W", f64, Free()},
    {"truth/walls/until_s", "W", f64, Free()},
    {"truth/robot/N/walls/time_s", "A", f64, Rising()},
    {"truth/robot/N/walls/angle_rad", "A", f64, Finite()},
    {"truth/doors/x_m", "D,2", f64, Position()},
    {"truth/doors/y_m", "D,2", f64, Position()},
    {"truth/doors/open", "D", u8, YesNo()},
    {"truth/person/time_s", "E", f64, Rising()},
    {"truth/person/x_m", "E", f64, Position()},
    {"truth/person/y_m", "E", f64, Position()},
    {"robot/N/SENSOR/time_s", "K", f64, Rising()},
    {"robot/N/SENSOR/range_m", "K,B", f64, NotNegative().OrNan()},
    {"robot/N/SENSOR/beam_x_m", "B", f64, Position()},
    {"robot/N/SENSOR/beam_y_m", "B", f64, Position()},
    {"robot/N/SENSOR/beam_heading_rad", "B", f64, Finite()},
    {"robot/N/SENSOR/turret_rad", "K", f64, Finite()},
    {"robot/N/SENSOR/opening_rad", "", f64, Between(0, 3.15)},
    {"robot/N/SENSOR/max_range_m", "", f64, Positive()},
    {"truth/robot/N/SENSOR/cause", "K,B", u8, Between(0, 4)},
};

constexpr ArraySpec kPoses[] = {
    {"robots", "R", text},
    {"robot/N/poses/time_s", "P", f64, Rising()},
    {"robot/N/poses/x_m", "P", f64, Position()},
    {"robot/N/poses/y_m", "P", f64, Position()},
    {"robot/N/poses/heading_rad", "P", f64, Finite()},
    {"robot/N/poses/covariance", "P,3,3", f64, Finite()},
};

}  // namespace

std::span<const ArraySpec> LogArrays() { return kLog; }
std::span<const ArraySpec> PoseArrays() { return kPoses; }

}  // namespace cairn
