#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "datasets/bag/import_bag.h"
#include "datasets/bag/inspect_bag.h"
#include "datasets/bag/message_reader.h"
#include "datasets/bag/testing_bag.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

namespace bag = datasets::bag;

constexpr std::uint8_t kSkipBadMessages = 1, kByReceipt = 2, kInspect = 4, kLandmarks = 8, kWheels = 16,
                       kTruth = 32, kCloud = 64;

void CheckBagLog(const Blob& log) {
  for (const char* table :
       {"robot/0/odometry/", "robot/0/observations/", "robot/0/laser/", "robot/0/sonar/"}) {
    if (!log.Has(std::string(table) + "time_s")) continue;
    const auto times = log.Get<double>(std::string(table) + "time_s");
    CAIRN_DEMAND(std::ranges::is_sorted(times), std::string(table) + " runs backwards");
    CAIRN_DEMAND(std::ranges::all_of(times, [](double t) { return std::isfinite(t); }), "no time");
  }
  if (!log.Has("robot/0/laser/range_m")) return;
  const double reach = log.Scalar<double>("robot/0/laser/max_range_m");
  CAIRN_DEMAND(std::ranges::all_of(log.Get<double>("robot/0/laser/range_m"),
                                   [&](double r) { return std::isnan(r) || (r > 0 && r < reach); }),
               "a range that no sensor gives");
}

Outcome RunBagFile(const std::string& path, std::uint8_t flags) {
  datasets::BagImportOptions options;
  options.files = {path};
  options.skip_bad = (flags & kSkipBadMessages) != 0;
  options.by_receipt = (flags & kByReceipt) != 0;
  if ((flags & kLandmarks) != 0) {
    options.scans = {"none"};
    options.landmarks = {"/scan:range=range_max,bearing=angle_min,id=header.frame_id", "/tags", "tf:las"};
  }
  if ((flags & kWheels) != 0) {
    options.wheels = "l,r,0.1,0.5";
    options.gyro = "/imu*2";
  }
  if ((flags & kTruth) != 0) {
    options.truth = "/fix";
    options.poses = "tf";
  }
  if ((flags & kCloud) != 0) {
    options.scans = {"/points"};
    options.cloud = "0,1,10";
  }
  Blob log;
  try {
    if ((flags & kInspect) != 0) datasets::BagText(datasets::InspectBag(path));
    datasets::ImportBag(options, &log);
  } catch (const InputError&) {
    return Outcome::kRefused;
  }
  CheckBagLog(log);
  return Outcome::kAccepted;
}

// Channels with messages of their own, in the order of their numbers, and of none that is not wanted.
Outcome RunContainerFile(const std::string& path, std::uint8_t flags) {
  try {
    const auto container = bag::OpenContainer(path);
    std::vector<bool> wanted;
    for (std::size_t i = 0; i < container->channels().size(); ++i)
      wanted.push_back((flags >> i % 8 & 1) != 0);
    std::vector<std::uint64_t> taken(wanted.size(), 0);
    std::uint64_t sum = 0, messages = 0;
    const auto take = [&](const bag::Message& message) {
      CAIRN_DEMAND(message.channel < wanted.size() && wanted[message.channel], "a message nobody wants");
      CAIRN_DEMAND(message.number == ++taken[message.channel], "a message of another number");
      for (const std::byte byte : message.bytes)
        sum += std::to_integer<std::uint64_t>(byte);  // each is there
      ++messages;
    };
    std::string broken;
    container->Read(wanted, take, [&](const std::string& what) { broken = what; });
    return messages == 0 || sum == 0 || !broken.empty() ? Outcome::kRefused : Outcome::kAccepted;
  } catch (const InputError&) {
    return Outcome::kRefused;
  }
}

// SQLite wants a path that is there when links in it have been followed.
template <Outcome (*Run)(const std::string&, std::uint8_t)>
Outcome RunFile(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Outcome::kRefused;
  const std::string_view file = AsText(bytes.subspan(1));
  if (!file.starts_with("SQLite")) return Run(MemoryFile(file).path(), bytes[0]);
  const ScratchFolder folder;
  folder.Put("a.db3", file);
  return Run(folder.path() / "a.db3", bytes[0]);
}

std::vector<bag::BagMessage> Drive(bag::Encoder::To to) {
  auto messages = bag::SmallDrive(to);
  messages.resize(6);
  messages.push_back(
      {"/tf", "tf2_msgs/TFMessage", 1000, bag::TransformMessage(to, 1000, "base_link", "laser", 0.1, 0.2)});
  messages.push_back(
      {"/tf", "tf2_msgs/TFMessage", 1000, bag::TransformMessage(to, 1000, "camera", "tag36h11:7", 1, 0)});
  messages.push_back(
      {"/tf", "tf2_msgs/TFMessage", 1000, bag::TransformMessage(to, 1000, "laser", "camera", 0, 0)});
  messages.push_back(
      {"/tags", "apriltag_msgs/AprilTagDetectionArray", 1000, bag::TagsMessage(to, 1000, {7, 8})});
  messages.push_back({"/points", "sensor_msgs/PointCloud2", 1000.5,
                      bag::CloudMessage(to, 1000.5, {{1, 0, 0.5F}, {0, 2, 5}}, "laser")});
  for (const double at_s : {1000.0, 1000.4, 1003.0}) {
    messages.push_back({"/fix", "sensor_msgs/NavSatFix", at_s, bag::FixMessage(to, at_s, at_s - 950, 7)});
    messages.push_back(
        {"/tf", "tf2_msgs/TFMessage", at_s, bag::TransformMessage(to, at_s, "map", "odom", at_s - 1000, 1)});
    messages.push_back(
        {"/tf", "tf2_msgs/TFMessage", at_s, bag::TransformMessage(to, at_s, "odom", "base_link", 0, at_s)});
    messages.push_back({"/imu", "sensor_msgs/Imu", at_s, bag::ImuMessage(to, at_s, 0.1, "laser")});
    messages.push_back({"/joints", "sensor_msgs/JointState", at_s,
                        bag::JointMessage(to, at_s, {"l", "r"}, {0.1 * at_s, 0.2 * at_s}, {1, 2})});
  }
  return messages;
}

// Of those topics alone: a run takes as long as its file.
std::vector<bag::BagMessage> DriveOf(bag::Encoder::To to, const std::string& topics) {
  std::vector<bag::BagMessage> messages = Drive(to);
  std::erase_if(messages, [&](const auto& one) { return topics.find(one.topic) == std::string::npos; });
  return messages;
}

std::string SqliteBytes(const std::vector<bag::BagMessage>& messages, bool has_definitions) {
  const ScratchFolder folder;
  const std::string path = folder.path() / "a.db3";
  bag::WriteSqliteBag(path, messages, has_definitions);
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<Bytes> ContainerSeeds() {
  using To = bag::Encoder::To;
  const auto ros1 = DriveOf(To::kRos1, "/odom /fix"), cdr = DriveOf(To::kCdr, "/odom /fix");
  std::vector<std::string> files;
  for (const char* how : {"none", "lz4", "bz2"}) files.push_back(bag::Ros1Bytes(ros1, how));
  files.push_back(bag::Ros1Bytes(ros1, "none", false));
  for (const char* how : {"", "lz4", "zstd"}) files.push_back(bag::McapBytes(cdr, how));
  for (const auto form : {bag::McapForm::kWithoutIndex, bag::McapForm::kWithoutChunks})
    files.push_back(bag::McapBytes(cdr, "", form));
  files.push_back(SqliteBytes(cdr, true));
  std::vector<Bytes> seeds;
  for (const std::string& file : files)
    for (const int flags : {255, 1, 2}) {
      seeds.emplace_back(file.begin(), file.end());
      seeds.back().insert(seeds.back().begin(), static_cast<std::uint8_t>(flags));
    }
  return seeds;
}

std::vector<Bytes> BagSeeds() {
  using To = bag::Encoder::To;
  std::vector<Bytes> seeds;
  for (const auto& [flags, topics] : {std::pair{0, "/odom /scan /tf"},
                                      {kSkipBadMessages | kInspect, "/odom /scan /tf"},
                                      {0 + kByReceipt, "/odom /scan /tf"},
                                      {0 + kLandmarks, "/odom /scan /tags /tf"},
                                      {0 + kWheels, "/joints /imu /tf"},
                                      {0 + kTruth, "/odom /fix /tf"},
                                      {0 + kCloud, "/odom /points /tf"}}) {
    const auto add = [&seeds, flag = flags](const std::string& file) {
      seeds.emplace_back(file.begin(), file.end());
      seeds.back().insert(seeds.back().begin(), static_cast<std::uint8_t>(flag));
    };
    const auto ros1 = DriveOf(To::kRos1, topics), cdr = DriveOf(To::kCdr, topics);
    for (const char* how : {"none", "lz4", "bz2"}) add(bag::Ros1Bytes(ros1, how));
    add(bag::Ros1Bytes(ros1, "none", false));
    std::vector<bag::BagMessage> two;  // robots, by their namespaces
    for (const char* robot : {"/a", "/b"})
      for (bag::BagMessage message : ros1) {
        message.topic = robot + message.topic;
        two.push_back(std::move(message));
      }
    if (std::string_view(topics).find("/scan") != std::string_view::npos) add(bag::Ros1Bytes(two));
    for (const char* how : {"", "lz4", "zstd"}) add(bag::McapBytes(cdr, how));
    add(bag::McapBytes(DriveOf(To::kBigCdr, topics), "", bag::McapForm::kWithoutIndex));
    add(bag::McapBytes(cdr, "", bag::McapForm::kWithoutChunks));
    for (const bool has_definitions : {false, true}) add(SqliteBytes(cdr, has_definitions));
  }
  return seeds;
}

Outcome RunBagMessage(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHead = 3;
  if (bytes.size() < kHead) return Outcome::kRefused;
  const std::size_t length = std::min<std::size_t>(bytes[1] + 256 * bytes[2], bytes.size() - kHead);
  const std::string_view text = AsText(bytes.subspan(kHead, length));
  try {
    bag::MessageReader reader(
        bag::ParseDefinition("a/B", text), bytes[0] % 2 == 0 ? bag::Wire::kRos1 : bag::Wire::kCdr,
        {"header.stamp", "header.frame_id", "pose.pose.position.x", "ranges", "transforms", "ranges.echoes"});
    const std::vector<bag::Found>& found = reader.Read(std::as_bytes(bytes.subspan(kHead + length)));
    for (const bag::Found& one : found)
      CAIRN_DEMAND(one.numbers.size() + one.texts.size() + one.bytes.size() <= bytes.size(),
                   "more fields than bytes");
  } catch (const bag::Damage&) {
    return Outcome::kRefused;
  }
  return Outcome::kAccepted;
}

std::vector<Bytes> BagMessageSeeds() {
  std::vector<Bytes> seeds;
  for (const bag::BagMessage& message : Drive(bag::Encoder::To::kRos1))
    for (const auto to : {bag::Encoder::To::kRos1, bag::Encoder::To::kCdr, bag::Encoder::To::kBigCdr}) {
      const auto same = Drive(to);
      const auto found = std::ranges::find(same, message.topic, &bag::BagMessage::topic);
      const std::string text = bag::DefinitionText(message.type, to == bag::Encoder::To::kRos1);
      Bytes seed = {static_cast<std::uint8_t>(to == bag::Encoder::To::kRos1 ? 0 : 1),
                    static_cast<std::uint8_t>(text.size() % 256),
                    static_cast<std::uint8_t>(text.size() / 256)};
      seed.insert(seed.end(), text.begin(), text.end());
      seed.insert(seed.end(), found->bytes.begin(), found->bytes.end());
      seeds.push_back(std::move(seed));
    }
  return seeds;
}

}  // namespace

Target BagTarget() { return {"bag", RunFile<RunBagFile>, BagSeeds, 2000}; }
Target BagContainerTarget() { return {"bag_container", RunFile<RunContainerFile>, ContainerSeeds, 20'000}; }
Target BagMessageTarget() { return {"bag_message", RunBagMessage, BagMessageSeeds, 4000}; }

}  // namespace cairn::fuzz
