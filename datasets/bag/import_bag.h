// `cairn import bag`: bags of ROS 1 (.bag) and ROS 2 (.db3, .mcap), read without ROS.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

struct BagImportOptions {
  std::vector<std::string> files;  // of one drive, in any order; folders of rosbag2 too
  std::string folder;              // for scans while they are read; empty: all are in memory
  std::uint64_t memory_mb = 0;     // that the child that reads them may take (in_child.h); 0: by their size
  bool skip_bad = false;  // skip bad messages and count them by reason, instead of stopping at the first
  NoiseParameters noise;
  // "NAMESPACE,NAMESPACE", of a robot each; empty: where all topics lie in several namespaces these; "none":
  // one robot.
  std::string robots;
  // Topics, of several robots as within its namespace; empty: the only one of its kind. `odometry`, `truth`
  // and `poses` may be "tf", `scans` and `sonars` "none".
  std::string odometry;
  std::string wheels;  // "LEFT_JOINT,RIGHT_JOINT,RADIUS_M,DISTANCE_M" (wheels.h), for odometry by joints
  std::string gyro;    // whose turn is the odometry's; "TOPIC*FACTOR" (landmark_readers.h)
  std::vector<std::string> scans, sonars;
  std::string cloud;  // "LOW_M,HIGH_M,REACH_M" (cloud.h): of scans that are clouds of points
  // Only where they are named: a pose may be where somebody wants the robot to go.
  std::string truth, poses;
  std::vector<std::string> landmarks;  // "TOPIC", "TOPIC:x=FIELD,y=FIELD", … (landmark_readers.h)
  std::vector<std::string> tags;       // "TOPIC=SIZE_M": AprilTags in images (tag_images.h)
  std::string tag_family = "tag36h11", camera;
  // The tags of a family in images, as cairn-tags has both (datasets/tags/find_tags.h).
  std::function<std::string(const std::string& family, const std::string& images)> find_tags;
  std::string base;                       // the robot's frame; empty: that of the odometry
  std::map<std::string, Pose> mounts;     // where a sensor sits on the robot, by topic or frame; else by tf
  bool by_receipt = false;                // times are the recorder's, not those of the messages' headers
  std::optional<double> from_s, until_s;  // since the first message, or, from 1e8 on, as the log has them
};

// Writes a `log` (schema/FORMAT.md). Lasers are `laser`, `laser2`, … in the order of `scans`;
// all sonars one ring `sonar` (infra-red sensors: `infrared`), a scan of which is what its sensors said in
// turn, at the time of the last of them. Poses are those of the odometry's topic, or of the frame that moves
// on "odom". Sensors sit where tf says. Markers become observations of landmarks. Throws
// InputError that names the file, the topic and the message's number among its topic's: a file that is no
// bag, or cut off; a topic that is not there, or of another type; several topics that would serve; a
// definition that has not what is needed, a message that does not match it; no finite pose; no time in a
// header, or one that runs backwards by more than a second; scans of other beams than their topic's first; a
// sensor of which nothing says where it sits.
ImportReport ImportBag(const BagImportOptions& options, Blob* log);

}  // namespace cairn::datasets
