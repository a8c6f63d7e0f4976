#include "datasets/bag/write_bag.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "datasets/bag/definition.h"
#include "datasets/bag/readers.h"
#include "schema/error.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000, kBegin_s = 1'000'000'000;
constexpr double kWheelRadius_m = 0.1, kWheelDistance_m = 0.4;

struct WrittenType {
  std::string_view type, md5;  // as ROS has it, of the whole definition
};
constexpr WrittenType kOdometryType{"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"},
    kJointsType{"sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd"},
    kRangeType{"sensor_msgs/Range", "c005c34273dc426c67a020a87bc24148"},
    kTransformsType{"tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec"},
    kPlacesType{"geometry_msgs/PoseArray", "916c28c5764443f268b296bb671b9d97"},
    kMarkersType{"aruco_msgs/MarkerArray", "9d486b76ee1f72a8b0d33e8c66a97306"},
    kHeaderType{"std_msgs/Header", "2176decaecbce78abc3b96ef049fabed"},
    kPoseType{"geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5"};

// Numbers as ROS 1 puts them one after the other, texts after their length.
class Bytes {
 public:
  template <class T>
  Bytes& Put(T value) {
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Bytes& Text(std::string_view text) {
    Put(static_cast<std::uint32_t>(text.size()));
    text_ += text;
    return *this;
  }
  Bytes& Time(std::int64_t ns) {
    return Put(static_cast<std::uint32_t>(ns / kSecond_ns)).Put(static_cast<std::uint32_t>(ns % kSecond_ns));
  }
  Bytes& Header(std::int64_t ns, std::string_view frame) {
    return Put<std::uint32_t>(0).Time(ns).Text(frame);
  }
  // In the plane: position and quaternion.
  Bytes& At(const Pose& pose) {
    for (const double number :
         {pose.x_m, pose.y_m, 0.0, 0.0, 0.0, std::sin(pose.heading_rad / 2), std::cos(pose.heading_rad / 2)})
      Put(number);
    return *this;
  }
  Bytes& Raw(std::string_view bytes) {
    text_ += bytes;
    return *this;
  }
  Bytes& Zeros(int count) {
    for (int i = 0; i < count; ++i) Put(0.0);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

struct RecordedMessage {
  std::int64_t ns = 0;
  std::string topic;
  const WrittenType* type = nullptr;
  std::string bytes;
};

std::int64_t Nanoseconds(double time_s) {
  return kBegin_s * kSecond_ns + static_cast<std::int64_t>(std::llround(1e9 * time_s));
}

// ---- the container: format 2.0 of ROS 1's bags ----
using HeaderFields = std::vector<std::pair<std::string_view, std::string>>;

std::string Record(const HeaderFields& fields, const std::string& data) {
  Bytes header;
  for (const auto& [name, value] : fields) header.Text(std::string(name) + "=" + value);
  return Bytes().Text(header.text()).Text(data).text();
}
std::string Op(char code) { return {code}; }
template <class T>
std::string Number(T value) {
  return Bytes().Put(value).text();
}

std::string TextOfType(const std::string& type) {
  std::string text;
  for (const bag::Type& part : bag::ParseDefinition(type, bag::KnownDefinition(type)).types) {
    if (!text.empty()) text += std::string(80, '=') + "\nMSG: " + part.name + "\n";
    // ROS 2 has no number in it.
    text += part.name == "std_msgs/Header" ? "uint32 seq\ntime stamp\nstring frame_id\n"
                                           : bag::KnownDefinition(part.name);
  }
  return text;
}

class BagBytes {
 public:
  void Add(const RecordedMessage& message) {
    const auto [found, is_new] =
        connections_.try_emplace(message.topic, static_cast<std::uint32_t>(connections_.size()));
    if (is_new) AddConnection(message, found->second);
    index_[found->second].Time(message.ns).Put(static_cast<std::uint32_t>(chunk_.size()));
    ++counts_[found->second];
    chunk_ +=
        Record({{"op", Op(2)}, {"conn", Number(found->second)}, {"time", Bytes().Time(message.ns).text()}},
               message.bytes);
    if (first_ns_ == 0) first_ns_ = message.ns;
    last_ns_ = message.ns;
    constexpr std::size_t kChunkBytes = 768 * 1024;
    if (chunk_.size() > kChunkBytes) EndChunk();
  }

  std::string Take() {
    EndChunk();
    const HeaderFields fields = {{"op", Op(3)},
                                 {"index_pos", Number<std::uint64_t>(kBodyAt + body_.size())},
                                 {"conn_count", Number(static_cast<std::uint32_t>(connections_.size()))},
                                 {"chunk_count", Number(chunks_)}};
    // Padded, so that it can be written once all is known.
    const std::string unpadded = Record(fields, "");
    return std::string(kMagic) + Record(fields, std::string(kHeaderBytes - unpadded.size(), ' ')) + body_ +
           connection_records_ + chunk_infos_;
  }

 private:
  static constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
  static constexpr std::size_t kHeaderBytes = 4096, kBodyAt = kMagic.size() + kHeaderBytes;

  void AddConnection(const RecordedMessage& message, std::uint32_t number) {
    const std::string type(message.type->type);
    Bytes about;
    for (const auto& [name, value] : HeaderFields{{"topic", message.topic},
                                                  {"type", type},
                                                  {"md5sum", std::string(message.type->md5)},
                                                  {"message_definition", TextOfType(type)},
                                                  {"latching", message.type == &kTransformsType ? "1" : "0"}})
      about.Text(std::string(name) + "=" + value);
    const std::string record =
        Record({{"op", Op(7)}, {"conn", Number(number)}, {"topic", message.topic}}, about.text());
    connection_records_ += record;
    chunk_ += record;
  }

  void EndChunk() {
    if (chunk_.empty()) return;
    const std::uint64_t at = kBodyAt + body_.size();
    body_ += Record(
        {{"op", Op(5)}, {"compression", "none"}, {"size", Number(static_cast<std::uint32_t>(chunk_.size()))}},
        chunk_);
    Bytes counts;
    for (const auto& [connection, entries] : index_) {
      body_ += Record({{"op", Op(4)},
                       {"ver", Number<std::uint32_t>(1)},
                       {"conn", Number(connection)},
                       {"count", Number(counts_[connection])}},
                      entries.text());
      counts.Put(connection).Put(counts_[connection]);
    }
    chunk_infos_ += Record({{"op", Op(6)},
                            {"ver", Number<std::uint32_t>(1)},
                            {"chunk_pos", Number(at)},
                            {"start_time", Bytes().Time(first_ns_).text()},
                            {"end_time", Bytes().Time(last_ns_).text()},
                            {"count", Number(static_cast<std::uint32_t>(index_.size()))}},
                           counts.text());
    ++chunks_;
    chunk_.clear();
    index_.clear();
    counts_.clear();
    first_ns_ = 0;
  }

  std::map<std::string, std::uint32_t> connections_;
  std::map<std::uint32_t, Bytes> index_;           // of the chunk: when, and where in it
  std::map<std::uint32_t, std::uint32_t> counts_;  // of the chunk: messages
  std::string chunk_, body_, connection_records_, chunk_infos_;
  std::uint32_t chunks_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
};

// ---- what a robot records ----
class RobotRecorder {
 public:
  RobotRecorder(std::string prefix, std::vector<RecordedMessage>* messages)
      : prefix_(std::move(prefix)), messages_(*messages) {}

  // A row is a turn, and then a way: a message of the wheels each.
  void AddOdometry(const kinds::Log::Odometry& odometry) {
    Pose at;
    double left_m = 0, right_m = 0;
    for (std::size_t i = 0; i < odometry.time_s.size(); ++i) {
      const std::int64_t ns = Nanoseconds(odometry.time_s[i]);
      const double turn_rad = odometry.turn_rad[i], forward_m = odometry.forward_m[i];
      left_m -= turn_rad * kWheelDistance_m / 2;
      right_m += turn_rad * kWheelDistance_m / 2;
      if (turn_rad != 0 && forward_m != 0) AddJoints(ns, left_m, right_m);
      left_m += forward_m;
      right_m += forward_m;
      AddJoints(ns, left_m, right_m);
      at = bag::Moved(bag::Moved(at, 0, 0, turn_rad), forward_m, 0, 0);
      if (i + 1 < odometry.time_s.size() && odometry.time_s[i + 1] == odometry.time_s[i]) continue;
      Add("odom", kOdometryType, ns,
          Bytes().Header(ns, "odom").Text("base_link").At(at).Zeros(36).Zeros(6).Zeros(36));
    }
  }

  void AddRing(const kinds::Log::RangeSensor& ring) {
    const bool is_infrared = ring.sensor == "infrared";
    if (ring.sensor != "sonar" && !is_infrared) return;
    if (ring.turret_rad && !ring.turret_rad.empty())
      throw InputError("a bag has no place for sensors on a turret");
    const std::size_t beams = ring.beam_x_m.size();
    Bytes transforms;
    transforms.Put(static_cast<std::uint32_t>(beams));
    for (std::size_t beam = 0; beam < beams; ++beam)
      transforms.Header(Nanoseconds(0), "base_link")
          .Text(NameOf(ring.sensor, beam))
          .At({ring.beam_x_m[beam], ring.beam_y_m[beam], ring.beam_heading_rad[beam]});
    Add("tf_static", kTransformsType, Nanoseconds(0), transforms);
    for (std::size_t scan = 0; scan < ring.time_s.size(); ++scan)
      for (std::size_t beam = 0; beam < beams; ++beam) {
        const std::int64_t ns = Nanoseconds(ring.time_s[scan]);
        const auto reach = static_cast<float>(ring.max_range_m[0]);
        const auto range = static_cast<float>(ring.range_m[scan * beams + beam]);
        const std::string name = NameOf(ring.sensor, beam);
        Add(name, kRangeType, ns,
            Bytes()
                .Header(ns, name)
                .Put<std::uint8_t>(is_infrared ? 1 : 0)
                .Put(static_cast<float>(ring.opening_rad[0]))
                .Put(0.0F)
                .Put(reach)
                .Put(std::isnan(range) ? reach : range));
      }
  }

  void AddLandmarks(const kinds::Log::Observations& seen) {
    for (std::size_t i = 0; i < seen.time_s.size();) {
      const double time_s = seen.time_s[i];
      const std::int64_t ns = Nanoseconds(time_s);
      std::uint32_t unnamed = 0, named = 0;
      Bytes places, markers;
      for (; i < seen.time_s.size() && seen.time_s[i] == time_s; ++i) {
        const double range = seen.range_m[i], bearing = seen.bearing_rad[i];
        const Pose at{range * std::cos(bearing), range * std::sin(bearing), 0};
        const Bytes header = Bytes().Header(ns, "base_link");
        if (std::isnan(range)) {
          Add("contacts", kHeaderType, ns, header);
        } else if (seen.landmark[i] < 0) {
          ++unnamed;
          places.At(at);
        } else {
          ++named;
          markers.Raw(header.text()).Put(seen.landmark[i]).At(at).Zeros(36).Put(1.0);
        }
      }
      for (const auto& [topic, type, count, bytes] : {std::tuple{"landmarks", &kPlacesType, unnamed, &places},
                                                      std::tuple{"markers", &kMarkersType, named, &markers}})
        if (count > 0) Add(topic, *type, ns, Bytes().Header(ns, "base_link").Put(count).Raw(bytes->text()));
    }
  }

  void AddTruth(const kinds::PoseTable& poses) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::int64_t ns = Nanoseconds(poses.time_s[i]);
      Add("truth", kPoseType, ns, Bytes().Header(ns, "map").At(poses[i]));
    }
  }

 private:
  static std::string NameOf(const std::string& sensor, std::size_t beam) {
    return fmt::format("{}_{:02}", sensor, beam);
  }
  void AddJoints(std::int64_t ns, double left_m, double right_m) {
    Bytes joints;
    joints.Header(ns, "").Put<std::uint32_t>(2).Text("left_wheel_joint").Text("right_wheel_joint");
    joints.Put<std::uint32_t>(2).Put(left_m / kWheelRadius_m).Put(right_m / kWheelRadius_m);
    joints.Put<std::uint32_t>(0).Put<std::uint32_t>(0);
    Add("joint_states", kJointsType, ns, joints);
  }
  void Add(const std::string& topic, const WrittenType& type, std::int64_t ns, const Bytes& bytes) {
    messages_.push_back({ns, prefix_ + "/" + topic, &type, bytes.text()});
  }

  std::string prefix_;
  std::vector<RecordedMessage>& messages_;
};

}  // namespace

std::string BagOfLog(const Blob& blob) {
  const auto log = Read<kinds::Log>(blob);
  std::vector<RecordedMessage> messages;
  for (std::size_t i = 0; i < log.robot.size(); ++i) {
    RobotRecorder robot(log.robot.size() == 1 ? "" : "/robot" + std::to_string(i), &messages);
    robot.AddOdometry(log.robot[i].odometry);
    for (const kinds::Log::RangeSensor& sensor : log.robot[i].sensors) robot.AddRing(sensor);
    robot.AddLandmarks(log.robot[i].observations);
    if (i < log.truth.robot.size()) robot.AddTruth(log.truth.robot[i].poses);
  }
  std::ranges::stable_sort(messages, {}, &RecordedMessage::ns);
  BagBytes bytes;
  for (const RecordedMessage& message : messages) bytes.Add(message);
  return bytes.Take();
}

}  // namespace cairn::datasets
