#include "datasets/bag/topics.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

constexpr std::string_view kAsTruth = "poses, with --truth or --poses",
                           kAsMarkers = "landmarks, with --landmarks",
                           kAsTags = "images in which AprilTags are landmarks, with --tags",
                           kAsVelocity = "odometry, with --odometry";
constexpr std::array kUses = {
    TypeUse{"nav_msgs/Odometry", Use::kOdometry, "odometry"},
    TypeUse{"geometry_msgs/TwistStamped", Use::kVelocity, kAsVelocity},
    TypeUse{"geometry_msgs/TwistWithCovarianceStamped", Use::kVelocity, kAsVelocity},
    TypeUse{"geometry_msgs/Twist", Use::kVelocity, kAsVelocity},
    TypeUse{"sensor_msgs/JointState", Use::kJoints, "odometry of two wheels, with --wheels"},
    TypeUse{"sensor_msgs/Imu", Use::kGyro, "the odometry's turn, with --gyro"},
    TypeUse{"tf2_msgs/TFMessage", Use::kTransforms, "where sensors sit"},
    TypeUse{"tf/tfMessage", Use::kTransforms, "where sensors sit"},
    TypeUse{"sensor_msgs/LaserScan", Use::kScan, "scans"},
    TypeUse{"sensor_msgs/MultiEchoLaserScan", Use::kScan, "scans"},
    TypeUse{"sensor_msgs/PointCloud2", Use::kCloud, "scans at a height, with --scan and --cloud"},
    TypeUse{"sensor_msgs/Range", Use::kCone, "scans of a ring of sonars"},
    TypeUse{"geometry_msgs/PoseStamped", Use::kPose, kAsTruth},
    TypeUse{"geometry_msgs/PoseWithCovarianceStamped", Use::kPose, kAsTruth},
    TypeUse{"geometry_msgs/TransformStamped", Use::kPose, kAsTruth},
    TypeUse{"nav_msgs/Path", Use::kPose, kAsTruth},
    TypeUse{"sensor_msgs/NavSatFix", Use::kFix, "true positions, with --truth"},
    TypeUse{"sensor_msgs/Image", Use::kImage, kAsTags},
    TypeUse{"sensor_msgs/CompressedImage", Use::kImage, kAsTags},
    TypeUse{"sensor_msgs/CameraInfo", Use::kCamera, "the camera of images, with --tags"},
    TypeUse{"apriltag_ros/AprilTagDetectionArray", Use::kLandmarks, kAsMarkers},
    TypeUse{"ar_track_alvar_msgs/AlvarMarkers", Use::kLandmarks, kAsMarkers},
    TypeUse{"aruco_msgs/MarkerArray", Use::kLandmarks, kAsMarkers},
    TypeUse{"fiducial_msgs/FiducialTransformArray", Use::kLandmarks, kAsMarkers},
    TypeUse{"vision_msgs/Detection3DArray", Use::kLandmarks, kAsMarkers},
    TypeUse{"isaac_ros_apriltag_interfaces/AprilTagDetectionArray", Use::kLandmarks, kAsMarkers},
    TypeUse{"ros2_aruco_interfaces/ArucoMarkers", Use::kLandmarks, kAsMarkers},
    TypeUse{"apriltag_msgs/AprilTagDetectionArray", Use::kLandmarks,
            "landmarks, with --landmarks and the tags' frames in tf"},
};

// Letters to be taken out, put in or changed, each at a cost of one.
std::size_t Distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

bool IsOf(const Topic& topic, const std::vector<Use>& uses) {
  return uses.empty() || (topic.use != nullptr && std::ranges::find(uses, topic.use->use) != uses.end());
}

// Where each of those that tell where a robot is lies in a namespace of its own.
std::string RobotsHint(const std::vector<Topic>& topics, Use use) {
  if (use != Use::kOdometry && use != Use::kJoints) return {};
  std::set<std::string> names;
  std::string list;
  for (const Topic& topic : topics) {
    if (!IsOf(topic, {use}) || topic.messages == 0) continue;
    const std::string name = NamespaceOf(topic.name);
    if (name.empty() || !names.insert(name).second) return {};
    list += (list.empty() ? "" : ",") + name;
  }
  return "; if these are several robots: --robots " + Printable(list, 200);
}

}  // namespace

std::string NamespaceOf(std::string_view topic) {
  if (topic.starts_with('/')) topic.remove_prefix(1);
  const std::size_t slash = topic.find('/');
  return slash == std::string_view::npos ? std::string() : std::string(topic.substr(0, slash));
}

std::vector<std::string> AtCommas(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

std::string NearestNames(const std::vector<std::string>& names, const std::string& name) {
  constexpr std::size_t kMostShown = 5, kMostLetters = 200;
  std::vector<std::pair<std::size_t, std::string>> sorted;
  for (const std::string& one : names)
    sorted.emplace_back(Distance(name.substr(0, kMostLetters), one.substr(0, kMostLetters)), one);
  std::ranges::sort(sorted);
  std::vector<std::string> nearest;
  for (std::size_t i = 0; i < std::min(kMostShown, sorted.size()); ++i) nearest.push_back(sorted[i].second);
  return NameList(nearest);
}

const TypeUse* FindUse(std::string_view type) {
  const auto found = std::ranges::find(kUses, type, &TypeUse::type);
  return found == kUses.end() ? nullptr : &*found;
}

std::vector<Topic> TopicsOf(const std::vector<std::unique_ptr<Container>>& bags) {
  std::map<std::pair<std::string, std::string>, std::uint64_t> counts;
  for (const auto& bag : bags)
    for (const Channel& channel : bag->channels()) counts[{channel.topic, channel.type}] += channel.messages;
  std::vector<Topic> topics;
  for (const auto& [topic, messages] : counts)
    topics.push_back({topic.first, topic.second, messages, FindUse(topic.second)});
  return topics;
}

std::string TopicList(const std::vector<Topic>& topics, const std::vector<Use>& uses) {
  std::string list;
  for (const Topic& topic : topics)
    if (IsOf(topic, uses) && topic.messages > 0)
      list += (list.empty() ? "" : ", ") + topic.name + " (" + std::to_string(topic.messages) + " of " +
              topic.type + ")";
  return list;
}

const Topic& FindTopic(const std::vector<Topic>& topics, const std::string& name,
                       const std::vector<Use>& uses, const std::string& option) {
  const Topic* other = nullptr;
  std::vector<std::string> names;
  for (const Topic& topic : topics) {
    names.push_back(topic.name);
    if (topic.name != name) continue;
    if (IsOf(topic, uses)) return topic;
    other = &topic;
  }
  const std::string wanted = TopicList(topics, uses);
  if (other != nullptr)
    throw InputError(option + " " + name + ": that topic is of " + other->type + "; " +
                     (wanted.empty() ? "there is none that serves" : "what serves: " + wanted));
  throw InputError(option + " " + name + ": there is no such topic; " +
                   (topics.empty() ? "there is none at all" : "the nearest: " + NearestNames(names, name)));
}

const Topic* OnlyTopic(const std::vector<Topic>& topics, Use use, const std::string& option) {
  const Topic* only = nullptr;
  for (const Topic& topic : topics) {
    if (!IsOf(topic, {use}) || topic.messages == 0) continue;
    if (only != nullptr)
      throw InputError("which topic? " + option + " TOPIC chooses one of: " + TopicList(topics, {use}) +
                       RobotsHint(topics, use));
    only = &topic;
  }
  return only;
}

}  // namespace cairn::datasets::bag
