#include "datasets/bag/choose_topics.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include "datasets/bag/definition.h"
#include "datasets/bag/landmark_readers.h"
#include "datasets/bag/wheels.h"
#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

class TopicChoice {
 public:
  TopicChoice(const BagImportOptions& options, const std::vector<std::unique_ptr<Container>>& bags,
              Gathered* into, const AddReader& add)
      : options_(options), bags_(bags), topics_(into->topics), into_(*into), add_(add) {}

  void Choose() {
    ChooseOdometry();
    ChooseGyro();
    ChooseScans(Use::kScan, "--scan", options_.scans);
    ChooseScans(Use::kCone, "--sonar", options_.sonars);
    ChoosePoses("--truth", options_.truth, &into_.truth, &into_.truth_by_tf);
    ChoosePoses("--poses", options_.poses, &into_.poses, &into_.poses_by_tf);
    for (const std::string& text : options_.landmarks) ChooseLandmarks(ParseLandmarkSource(text));
    for (const std::string& text : options_.tags) ChooseTags(ParseTagSource(text));
    CompareWithOtherOdometries();
  }

 private:
  void ChoosePoses(const char* option, const std::string& name, SpooledRows<PoseRow>* rows, bool* by_tf) {
    if (name.empty()) return;
    *by_tf = name == "tf";
    if (*by_tf) return;
    std::vector<Use> uses = {Use::kPose, Use::kOdometry};
    if (rows == &into_.truth) uses.push_back(Use::kFix);
    const Topic& topic = FindTopic(topics_, name, uses, option);
    if (topic.use->use != Use::kFix) return add_(topic, ReadPoses(topic.type, rows));
    into_.fixes.topic = topic.name;
    add_(topic, ReadFixes(&into_.fixes));
  }

  // Whatever the log has, it is held against these.
  void CompareWithOtherOdometries() {
    for (const Topic& topic : topics_) {
      if (topic.use == nullptr || topic.use->use != Use::kOdometry || topic.name == into_.odometry_topic ||
          topic.name == options_.truth || topic.name == options_.poses)
        continue;
      into_.others.push_back(std::make_unique<OtherOdometry>());
      into_.others.back()->topic = topic.name;
      into_.others.back()->rows.poses = SpooledRows<PoseRow>(into_.folder);
      add_(topic, ReadOdometry(&into_.others.back()->rows, true));
    }
  }

  void ChooseLandmarks(const LandmarkSource& source) {
    if (!source.beginning.empty()) {
      into_.followed.beginnings.push_back(source.beginning);
      return;
    }
    const Topic& topic = FindTopic(topics_, source.topic, {}, "--landmarks");
    if (source.has_fields()) return add_(topic, ReadLandmarkFields(source, &into_.landmarks));
    if (topic.use == nullptr || topic.use->use != Use::kLandmarks)
      throw InputError("--landmarks " + topic.name + ": that topic is of " + topic.type +
                       ", whose fields are to be named: --landmarks " + topic.name +
                       ":range=FIELD,bearing=FIELD or x=, y=, each with id= (docs/bags.md); it has " +
                       FieldsOf(topic));
    add_(topic, ReadLandmarks(topic.type, &into_.landmarks, &into_.tags));
    into_.followed.with_tags = true;
  }

  // Images lie beside their camera_info, compressed ones below.
  void ChooseTags(TagSource source) {
    const Topic& topic = FindTopic(topics_, source.topic, {Use::kImage}, "--tags");
    TagCamera& camera = *into_.cameras.emplace_back(std::make_unique<TagCamera>(std::move(source), options_));
    add_(topic, camera.ReadImages(topic.type));
    if (camera.has_camera()) return;
    std::string at = topic.name;
    for (int up = 0; up < 2 && !at.empty(); ++up) {
      at.resize(std::min(at.rfind('/'), at.size()));
      const auto info = std::ranges::find(topics_, at + "/camera_info", &Topic::name);
      if (info == topics_.end() || info->use == nullptr || info->use->use != Use::kCamera) continue;
      return add_(*info, camera.ReadInfo());
    }
  }

  std::string FieldsOf(const Topic& topic) const {
    constexpr std::size_t kMostShown = 30;
    for (const auto& one : bags_)
      for (const Channel& channel : one->channels())
        if (channel.topic == topic.name && channel.type == topic.type && !DefinitionOf(channel).empty()) try {
            return NameList(FieldPaths(ParseDefinition(channel.type, DefinitionOf(channel))), kMostShown);
          } catch (const Damage& damage) {
            return damage.what;
          }
    return "a definition that the file does not carry";
  }

  void ChooseOdometry() {
    into_.odometry_topic = options_.odometry;
    if (options_.odometry == "tf") return;
    const Topic* topic = nullptr;
    if (!options_.wheels.empty()) return ChooseJoints();
    if (!options_.odometry.empty()) {
      topic = &FindTopic(topics_, options_.odometry, {Use::kOdometry, Use::kVelocity}, "--odometry");
    } else {
      topic = OnlyTopic(WithoutPoses(), Use::kOdometry, "--odometry");
      if (topic == nullptr) {
        into_.odometry_topic = "tf";
        return;
      }
      topic = &FindTopic(topics_, topic->name, {Use::kOdometry}, "--odometry");
    }
    into_.odometry_topic = topic->name;
    add_(*topic, topic->use->use == Use::kOdometry ? ReadOdometry(&into_.odometry)
                                                   : ReadVelocity(topic->type, &into_.odometry));
  }

  void ChooseJoints() {
    const Wheels wheels = ParseWheels(options_.wheels);
    const Topic* topic = options_.odometry.empty()
                             ? OnlyTopic(topics_, Use::kJoints, "--odometry")
                             : &FindTopic(topics_, options_.odometry, {Use::kJoints}, "--odometry");
    if (topic == nullptr) throw InputError("--wheels: there is no topic of sensor_msgs/JointState");
    into_.odometry_topic = topic->name;
    add_(*topic, ReadWheels(wheels, &into_.odometry));
  }

  void ChooseGyro() {
    if (options_.gyro.empty()) return;
    const ScaledField named = ParseScaledField(options_.gyro, "--gyro " + options_.gyro);
    const Topic& topic = FindTopic(topics_, named.path, {Use::kGyro}, "--gyro");
    into_.gyro.topic = topic.name;
    into_.gyro.factor = named.factor;
    add_(topic, ReadGyro(&into_.gyro));
  }

  // What is named as the truth is no odometry to choose from.
  const std::vector<Topic>& WithoutPoses() {
    others_.clear();
    for (const Topic& topic : topics_)
      if (topic.name != options_.truth && topic.name != options_.poses) others_.push_back(topic);
    return others_;
  }

  static std::vector<Use> UsesOf(Use use) {
    if (use == Use::kScan) return {Use::kScan, Use::kCloud};
    return {use};
  }

  std::unique_ptr<TopicReader> ReaderOfCloud(const Topic& topic, ScanTopic* scan) const {
    if (options_.cloud.empty())
      throw InputError(
          "--scan " + topic.name +
          ": that is of clouds of points: --cloud LOW_M,HIGH_M,REACH_M says which of them count, such "
          "as 0.2,0.5,20");
    return ReadCloud(ParseCloudCut(options_.cloud), into_.find_mount, scan);
  }

  void ChooseScans(Use use, const char* option, const std::vector<std::string>& names) {
    if (names.size() == 1 && names.front() == "none") return;
    std::vector<const Topic*> chosen;
    for (const std::string& name : names) chosen.push_back(&FindTopic(topics_, name, UsesOf(use), option));
    if (names.empty() && use == Use::kScan) {
      if (const Topic* only = OnlyTopic(topics_, use, option)) chosen.push_back(only);
    } else if (names.empty()) {
      for (const Topic& topic : topics_)  // a ring is of several
        if (topic.use != nullptr && topic.use->use == use && topic.messages > 0) chosen.push_back(&topic);
    }
    std::vector<std::unique_ptr<ScanTopic>>& scans = use == Use::kScan ? into_.scans : into_.sonars;
    for (const Topic* topic : chosen) {
      scans.push_back(std::make_unique<ScanTopic>());
      scans.back()->topic = topic->name;
      scans.back()->folder = options_.folder;
      scans.back()->times = SpooledRows<ScanTime>(options_.folder);
      scans.back()->cones = SpooledRows<ConeReading>(options_.folder);
      add_(*topic, topic->use->use == Use::kCloud ? ReaderOfCloud(*topic, scans.back().get())
                                                  : ReadScans(topic->type, scans.back().get()));
    }
  }

  const BagImportOptions& options_;
  const std::vector<std::unique_ptr<Container>>& bags_;
  const std::vector<Topic>& topics_;
  std::vector<Topic> others_;
  Gathered& into_;
  const AddReader& add_;
};

std::string InNamespace(const std::string& robot, const std::string& name) {
  return "/" + robot + (name.starts_with('/') ? "" : "/") + name;
}

bool IsOfRobot(const std::string& topic, const std::string& robot) {
  return topic.starts_with("/" + robot + "/") || topic.starts_with(robot + "/");
}

// Where every topic that tells where a robot is, or what it saw, lies in a namespace, and each of these has
// both: they are robots.
std::vector<std::string> NamespacesOfRobots(const std::vector<Topic>& topics) {
  constexpr std::size_t kMostRobots = 1000;
  std::set<std::string> moving, seeing;
  for (const Topic& topic : topics) {
    if (topic.use == nullptr || topic.messages == 0) continue;
    const Use use = topic.use->use;
    if (use == Use::kOdometry)
      moving.insert(NamespaceOf(topic.name));
    else if (use == Use::kScan || use == Use::kCone || use == Use::kLandmarks)
      seeing.insert(NamespaceOf(topic.name));
  }
  if (moving != seeing || moving.contains("") || moving.size() < 2 || moving.size() > kMostRobots) return {};
  return {moving.begin(), moving.end()};
}

}  // namespace

std::string_view DefinitionOf(const Channel& channel) {
  return channel.definition.empty() ? KnownDefinition(channel.type) : channel.definition;
}

bool HasTopic(const std::vector<Topic>& topics, const std::string& name) {
  return std::ranges::find(topics, name, &Topic::name) != topics.end();
}

std::vector<std::string> RobotsOf(const BagImportOptions& options, const std::vector<Topic>& topics) {
  if (options.robots == "none") return {};
  if (options.robots.empty()) {
    // Who names one robot's odometry means that robot.
    return HasTopic(topics, options.odometry) ? std::vector<std::string>() : NamespacesOfRobots(topics);
  }
  std::vector<std::string> robots;
  for (std::string robot : AtCommas(options.robots)) {
    if (robot.starts_with('/')) robot.erase(0, 1);
    const auto is_of = [&](const Topic& topic) { return IsOfRobot(topic.name, robot); };
    if (robot.empty() || std::ranges::none_of(topics, is_of)) {
      std::set<std::string> known;
      for (const Topic& topic : topics) known.insert(NamespaceOf(topic.name));
      known.erase("");
      throw InputError(
          "--robots " + Printable(robot, 80) +
          ": there is no topic in that namespace; there are: " + NameList({known.begin(), known.end()}, 20));
    }
    if (std::ranges::find(robots, robot) != robots.end())
      throw InputError("--robots " + robot + ": named twice");
    robots.push_back(robot);
  }
  return robots;
}

std::vector<Topic> TopicsOfRobot(const std::vector<Topic>& topics, const std::vector<std::string>& robots,
                                 const std::string& robot) {
  if (robots.empty()) return topics;
  std::vector<Topic> own;
  for (const Topic& topic : topics) {
    const auto is_of = [&](const std::string& other) { return IsOfRobot(topic.name, other); };
    const bool is_for_all = topic.use != nullptr && topic.use->use == Use::kTransforms;
    if (is_of(robot) || (is_for_all && std::ranges::none_of(robots, is_of))) own.push_back(topic);
  }
  return own;
}

BagImportOptions OptionsOfRobot(const BagImportOptions& options, const std::vector<std::string>& robots,
                                const Gathered& robot) {
  if (robots.empty()) return options;
  BagImportOptions own = options;
  // The name of the robot's own topic; empty where another robot's is meant.
  const auto resolve = [&](const std::string& name) {
    if (name.empty() || name == "tf" || name == "none" || IsOfRobot(name, robot.robot)) return name;
    const auto is_of = [&](const std::string& other) { return IsOfRobot(name, other); };
    return std::ranges::any_of(robots, is_of) ? std::string() : InNamespace(robot.robot, name);
  };
  for (std::string* name : {&own.odometry, &own.gyro, &own.truth, &own.poses}) *name = resolve(*name);
  for (std::vector<std::string>* names : {&own.scans, &own.sonars}) {
    for (std::string& name : *names) name = resolve(name);
    std::erase(*names, "");
  }
  const auto resolve_before = [&](char end, std::vector<std::string>* texts) {
    for (std::string& text : *texts) {
      const std::size_t at = std::min(text.find(end), text.size());
      const std::string name = resolve(text.substr(0, at));
      text = name.empty() ? "" : name + text.substr(at);
    }
    std::erase(*texts, "");
  };
  resolve_before(':', &own.landmarks);
  resolve_before('=', &own.tags);
  return own;
}

void ChooseTopics(const BagImportOptions& options, const std::vector<std::unique_ptr<Container>>& bags,
                  Gathered* into, const AddReader& add) {
  into->base = options.base;
  TopicChoice(options, bags, into, add).Choose();
}

}  // namespace cairn::datasets::bag
