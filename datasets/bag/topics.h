// Which topics of bags Cairn can use, as what, and which of them an import takes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/bag/container.h"

namespace cairn::datasets::bag {

enum class Use {
  kOdometry,    // poses by odometry
  kVelocity,    // as odometry, where somebody says so: it may be what was commanded
  kJoints,      // as odometry, where somebody says which are the wheels, and how large
  kGyro,        // the turn of the odometry, where somebody says so
  kTransforms,  // where sensors sit; odometry, where there is no other
  kScan,        // of a laser
  kCloud,       // a scan at a height, where somebody says at which
  kCone,        // of a sonar or an infra-red sensor
  kPose,        // where the robot was, where somebody says that it is the truth, or a corrected pose
  kFix,         // where it was by satellites, where somebody says that it is the truth
  kImage,       // in which there may be tags
  kCamera,      // what images are taken with
  kLandmarks,   // markers with identities, and where they were seen
};

struct TypeUse {
  std::string_view type;
  Use use;
  std::string_view as;  // for people
};
// Nothing where Cairn has no use for messages of such a type.
const TypeUse* FindUse(std::string_view type);

struct Topic {
  std::string name, type;
  std::uint64_t messages = 0;
  const TypeUse* use = nullptr;
};
// Of all of them together, in the order of their names.
std::vector<Topic> TopicsOf(const std::vector<std::unique_ptr<Container>>& bags);

// The topic of that name. Throws InputError where there is none, with the nearest names, or where it is none
// of `uses` (if there are any), with those that are.
const Topic& FindTopic(const std::vector<Topic>& topics, const std::string& name,
                       const std::vector<Use>& uses, const std::string& option);
// The only topic of `use` that has messages; nothing where there is none. Throws InputError where there are
// several: `option` chooses.
const Topic* OnlyTopic(const std::vector<Topic>& topics, Use use, const std::string& option);
// "robot1" of "/robot1/odom"; empty where it is in no namespace.
std::string NamespaceOf(std::string_view topic);
// "a,b" as "a" and "b".
std::vector<std::string> AtCommas(const std::string& text);
// "'targets.x', …": those of `names` that are most like `name`.
std::string NearestNames(const std::vector<std::string>& names, const std::string& name);
// "/odom (1200 messages of nav_msgs/Odometry), …" of those of `uses` with messages.
std::string TopicList(const std::vector<Topic>& topics, const std::vector<Use>& uses);

}  // namespace cairn::datasets::bag
