#include <array>

#include "datasets/bag/definition.h"

namespace cairn::datasets::bag {
namespace {

struct Known {
  std::string_view type, text;
};

// Fields alone, in their order: what ROS 2 says of them (common_interfaces, geometry2). Types in them stand
// in the table too.
constexpr std::array kKnown = {
    Known{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    Known{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    Known{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    Known{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    Known{"geometry_msgs/Pose", "Point position\nQuaternion orientation\n"},
    Known{"geometry_msgs/PoseArray", "std_msgs/Header header\nPose[] poses\n"},
    Known{"geometry_msgs/PoseStamped", "std_msgs/Header header\nPose pose\n"},
    Known{"geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n"},
    Known{"geometry_msgs/PoseWithCovarianceStamped", "std_msgs/Header header\nPoseWithCovariance pose\n"},
    Known{"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n"},
    Known{"geometry_msgs/TransformStamped",
          "std_msgs/Header header\nstring child_frame_id\nTransform transform\n"},
    Known{"geometry_msgs/Twist", "Vector3 linear\nVector3 angular\n"},
    Known{"geometry_msgs/TwistStamped", "std_msgs/Header header\nTwist twist\n"},
    Known{"geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance\n"},
    Known{"geometry_msgs/TwistWithCovarianceStamped", "std_msgs/Header header\nTwistWithCovariance twist\n"},
    Known{"nav_msgs/Odometry",
          "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
          "geometry_msgs/TwistWithCovariance twist\n"},
    Known{"nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
    Known{"sensor_msgs/LaserScan",
          "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
          "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
          "float32[] ranges\nfloat32[] intensities\n"},
    Known{"sensor_msgs/LaserEcho", "float32[] echoes\n"},
    Known{"sensor_msgs/MultiEchoLaserScan",
          "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
          "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
          "LaserEcho[] ranges\nLaserEcho[] intensities\n"},
    // Jazzy puts a `variance` behind it, and carries its definition.
    Known{"sensor_msgs/Range",
          "uint8 ULTRASOUND=0\nuint8 INFRARED=1\nstd_msgs/Header header\nuint8 radiation_type\nfloat32 "
          "field_of_view\nfloat32 min_range\n"
          "float32 max_range\nfloat32 range\n"},
    Known{"sensor_msgs/Imu",
          "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
          "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
          "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
          "float64[9] linear_acceleration_covariance\n"},
    Known{"sensor_msgs/NavSatStatus", "int8 status\nuint16 service\n"},
    Known{"sensor_msgs/NavSatFix",
          "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
          "float64 altitude\nfloat64[9] position_covariance\nuint8 position_covariance_type\n"},
    Known{"sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    Known{"sensor_msgs/PointCloud2",
          "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool "
          "is_bigendian\n"
          "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
    Known{"sensor_msgs/Image",
          "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
          "uint32 step\nuint8[] data\n"},
    Known{"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
    Known{"sensor_msgs/RegionOfInterest",
          "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"},
    Known{"sensor_msgs/CameraInfo",
          "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
          "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
          "sensor_msgs/RegionOfInterest roi\n"},
    Known{"sensor_msgs/JointState",
          "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
          "float64[] effort\n"},
    Known{"aruco_msgs/Marker",
          "std_msgs/Header header\nuint32 id\ngeometry_msgs/PoseWithCovariance pose\nfloat64 confidence\n"},
    Known{"aruco_msgs/MarkerArray", "std_msgs/Header header\naruco_msgs/Marker[] markers\n"},
    // apriltag_msgs 2: its Point is two float64.
    Known{"apriltag_msgs/AprilTagDetection",
          "string family\nint32 id\nint32 hamming\nfloat32 goodness\nfloat32 decision_margin\n"
          "float64[2] centre\nfloat64[8] corners\nfloat64[9] homography\n"},
    Known{"apriltag_msgs/AprilTagDetectionArray",
          "std_msgs/Header header\napriltag_msgs/AprilTagDetection[] detections\n"},
    Known{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
};

}  // namespace

std::string_view KnownDefinition(std::string_view type) {
  for (const Known& known : kKnown)
    if (known.type == type) return known.text;
  return {};
}

}  // namespace cairn::datasets::bag
