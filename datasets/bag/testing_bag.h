// Small bags for tests: messages of the types that Cairn reads, and the containers they lie in.
#pragma once

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/bag/definition.h"
#include "schema/error.h"

namespace cairn::datasets::bag {

// A message's bytes, field by field.
class Encoder {
 public:
  enum class To { kRos1, kCdr, kBigCdr };
  explicit Encoder(To to) : to_(to) {
    if (to != To::kRos1) text_ = to == To::kCdr ? std::string("\0\1\0\0", 4) : std::string(4, '\0');
  }
  template <class T>
  Encoder& Put(T value) {
    while (to_ != To::kRos1 && (text_.size() - 4) % sizeof(T) != 0) text_ += '\0';
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (to_ == To::kBigCdr) std::ranges::reverse(bytes);
    text_ += bytes;
    return *this;
  }
  Encoder& Text(std::string_view text) {
    Put<std::uint32_t>(static_cast<std::uint32_t>(text.size() + (to_ == To::kRos1 ? 0 : 1)));
    text_ += text;
    if (to_ != To::kRos1) text_ += '\0';
    return *this;
  }
  Encoder& Header(double stamp_s, std::string_view frame) {
    if (to_ == To::kRos1) Put<std::uint32_t>(0);
    const double whole_s = std::floor(stamp_s);
    Put(static_cast<std::uint32_t>(whole_s));
    Put(static_cast<std::uint32_t>(std::lround(1e9 * (stamp_s - whole_s))));
    return Text(frame);
  }
  Encoder& Doubles(std::initializer_list<double> values) {
    for (const double value : values) Put(value);
    return *this;
  }
  Encoder& Floats(const std::vector<float>& values) {
    Put(static_cast<std::uint32_t>(values.size()));
    for (const float value : values) Put(value);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  To to_;
  std::string text_;
};

inline std::string OdometryMessage(Encoder::To to, double stamp_s, double x, double heading,
                                   double variance = 0, double y = 0) {
  Encoder out(to);
  out.Header(stamp_s, "odom")
      .Text("base_link")
      .Doubles({x, y, 0, 0, 0, std::sin(heading / 2), std::cos(heading / 2)});
  for (int i = 0; i < 36; ++i) out.Put(i == 35 ? variance : 0.0);
  for (int i = 0; i < 6 + 36; ++i) out.Put(0.0);
  return out.text();
}

inline std::string ScanMessage(Encoder::To to, double stamp_s, const std::vector<float>& ranges,
                               const std::string& frame = "base_link",
                               const std::vector<float>& intensities = {}) {
  Encoder out(to);
  out.Header(stamp_s, frame);
  for (const float value : {-1.0F, 1.0F, 0.5F, 0.0F, 0.0F, 0.1F, 20.0F}) out.Put(value);
  return out.Floats(ranges).Floats(intensities).text();
}

inline std::string TransformMessage(Encoder::To to, double stamp_s, const std::string& parent,
                                    const std::string& child, double x, double heading,
                                    bool is_upside_down = false) {
  Encoder out(to);
  out.Put<std::uint32_t>(1).Header(stamp_s, parent).Text(child).Doubles({x, 0, 0.3});
  // Turned about z, and before that about x by half a turn.
  const double s = std::sin(heading / 2), c = std::cos(heading / 2);
  if (is_upside_down) return out.Doubles({c, s, 0, 0}).text();
  return out.Doubles({0, 0, s, c}).text();
}

// Turning about its z axis.
inline std::string ImuMessage(Encoder::To to, double stamp_s, double rate_radps,
                              const std::string& frame = "base_link") {
  Encoder out(to);
  out.Header(stamp_s, frame).Doubles({0, 0, 0, 1});
  for (int i = 0; i < 9; ++i) out.Put(0.0);
  out.Doubles({0, 0, rate_radps});
  for (int i = 0; i < 9 + 3 + 9; ++i) out.Put(0.0);
  return out.text();
}

inline std::string JointMessage(Encoder::To to, double stamp_s, const std::vector<std::string>& names,
                                const std::vector<double>& positions,
                                const std::vector<double>& velocities = {}) {
  Encoder out(to);
  out.Header(stamp_s, "").Put(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) out.Text(name);
  for (const std::vector<double>& numbers : {positions, velocities, {}}) {
    out.Put(static_cast<std::uint32_t>(numbers.size()));
    for (const double number : numbers) out.Put(number);
  }
  return out.text();
}

// `status`: -1 is no fix.
inline std::string FixMessage(Encoder::To to, double stamp_s, double latitude_deg, double longitude_deg,
                              std::int8_t status = 0, double variance = 0) {
  Encoder out(to);
  out.Header(stamp_s, "gps").Put(status).Put<std::uint16_t>(1).Doubles({latitude_deg, longitude_deg, 100});
  for (int i = 0; i < 9; ++i) out.Put(i % 4 == 0 ? variance : 0.0);
  return out.Put<std::uint8_t>(variance > 0 ? 2 : 0).text();
}

// Points of x, y, z and an intensity, in one row.
inline std::string CloudMessage(Encoder::To to, double stamp_s,
                                const std::vector<std::array<float, 3>>& points,
                                const std::string& frame = "base_link") {
  Encoder out(to);
  out.Header(stamp_s, frame).Put<std::uint32_t>(1).Put(static_cast<std::uint32_t>(points.size()));
  out.Put<std::uint32_t>(4);
  std::uint32_t offset = 0;
  for (const char* name : {"intensity", "x", "y", "z"}) {
    out.Text(name).Put(offset).Put<std::uint8_t>(7).Put<std::uint32_t>(1);
    offset += 4;
  }
  const auto bytes = static_cast<std::uint32_t>(offset * points.size());
  out.Put<std::uint8_t>(0).Put(offset).Put(bytes).Put(bytes);
  for (const std::array<float, 3>& point : points)
    for (const float number : {0.5F, point[0], point[1], point[2]})
      for (const char byte : std::string(reinterpret_cast<const char*>(&number), sizeof number))
        out.Put(byte);
  return out.Put<std::uint8_t>(1).text();
}

// As apriltag_ros of ROS 2 has it: where in the image tags of 36h11 are.
inline std::string TagsMessage(Encoder::To to, double stamp_s, const std::vector<int>& ids) {
  Encoder out(to);
  out.Header(stamp_s, "camera").Put(static_cast<std::uint32_t>(ids.size()));
  for (const int id : ids) {
    out.Text("tag36h11").Put(id).Put(0).Put(0.0F).Put(50.0F);
    for (int i = 0; i < 2 + 8 + 9; ++i) out.Put(1.0 * i);
  }
  return out.text();
}

// The text of a type as a bag of ROS 1, or of ROS 2, carries it: what Cairn knows of it, with all types in
// it. `own`: of a type that Cairn does not know.
inline std::string DefinitionText(const std::string& type, bool is_ros1, const std::string& own = {}) {
  std::string text(KnownDefinition(type == "tf/tfMessage" ? "tf2_msgs/TFMessage" : type));
  if (!own.empty()) text = own;
  CAIRN_DEMAND(!text.empty(), type);
  for (const char* part :
       {"geometry_msgs/TransformStamped", "geometry_msgs/Transform", "geometry_msgs/PoseStamped",
        "geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose", "geometry_msgs/TwistWithCovariance",
        "geometry_msgs/Twist", "geometry_msgs/Point", "geometry_msgs/Vector3", "geometry_msgs/Quaternion",
        "sensor_msgs/LaserEcho", "apriltag_msgs/AprilTagDetection", "sensor_msgs/NavSatStatus",
        "sensor_msgs/PointField", "sensor_msgs/RegionOfInterest", "std_msgs/Header"}) {
    const std::string_view name = std::string_view(part).substr(std::string_view(part).find('/') + 1);
    if (text.find(name) == std::string::npos) continue;  // nothing of it
    text += std::string(80, '=') + "\nMSG: " + part + "\n";
    if (is_ros1 && std::string_view(part) == "std_msgs/Header")
      text += "# of ROS 1\nuint32 seq\ntime stamp\nstring frame_id\n";
    else
      text += KnownDefinition(part);
  }
  return text;
}

struct BagMessage {
  std::string topic, type;
  double receive_s;
  std::string bytes;
  std::string definition = {};  // of a type that Cairn does not know
};

inline std::string Number32(std::uint64_t value) { return {reinterpret_cast<const char*>(&value), 4}; }
inline std::string Number64(std::uint64_t value) { return {reinterpret_cast<const char*>(&value), 8}; }
inline std::string Block(const std::string& text) { return Number32(text.size()) + text; }

inline std::string Pack(const std::string& how, const std::string& text) {
  if (how == "lz4") {
    std::string packed(LZ4F_compressFrameBound(text.size(), nullptr), '\0');
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), text.data(), text.size(), nullptr));
    return packed;
  }
  if (how == "zstd") {
    std::string packed(ZSTD_compressBound(text.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 1));
    return packed;
  }
  if (how == "bz2") {
    std::string packed(text.size() + text.size() / 50 + 600, '\0');
    auto size = static_cast<unsigned>(packed.size());
    std::string copy = text;
    const int code = BZ2_bzBuffToBuffCompress(packed.data(), &size, copy.data(),
                                              static_cast<unsigned>(copy.size()), 1, 0, 0);
    CAIRN_DEMAND(code == BZ_OK, "bz2");
    packed.resize(size);
    return packed;
  }
  return text;
}

// A bag of ROS 1: each message in a chunk of its own. Without an index: as a recorder leaves it that was
// killed.
inline std::string Ros1Bytes(const std::vector<BagMessage>& messages, const std::string& how = "none",
                             bool is_indexed = true, const std::string& encryptor = "") {
  using Fields = std::vector<std::pair<std::string, std::string>>;
  const auto header = [](const Fields& fields) {
    std::string text;
    for (const auto& [name, value] : fields) text += Block(name + "=" + value);
    return text;
  };
  const auto record = [&](const Fields& fields, const std::string& data) {
    return Block(header(fields)) + Block(data);
  };
  const auto time = [](double s) {
    const double whole_s = std::floor(s);
    return Number32(static_cast<std::uint64_t>(whole_s)) +
           Number32(static_cast<std::uint64_t>(std::lround(1e9 * (s - whole_s))));
  };
  const auto op = [](char code) { return std::string(1, code); };
  std::map<std::string, std::uint32_t> connections;
  std::string connection_records, chunk_infos, body;
  constexpr std::size_t kHeaderBytes = 4096, kMagicBytes = 13;
  for (const BagMessage& message : messages) {
    const auto [connection, is_new] =
        connections.try_emplace(message.topic, static_cast<std::uint32_t>(connections.size()));
    const std::string conn = Number32(connection->second);
    const std::string about =
        record({{"op", op(7)}, {"conn", conn}, {"topic", message.topic}},
               header({{"topic", message.topic},
                       {"type", message.type},
                       {"md5sum", "0"},
                       {"message_definition", DefinitionText(message.type, true, message.definition)}}));
    if (is_new) connection_records += about;
    const std::string when = time(message.receive_s);
    const std::string chunk =
        (is_new ? about : "") + record({{"op", op(2)}, {"conn", conn}, {"time", when}}, message.bytes);
    const std::string at = Number64(kMagicBytes + kHeaderBytes + body.size());
    body += record({{"op", op(5)}, {"compression", how}, {"size", Number32(chunk.size())}}, Pack(how, chunk));
    body += record({{"op", op(4)}, {"ver", Number32(1)}, {"conn", conn}, {"count", Number32(1)}},
                   when + Number32(0));
    chunk_infos += record({{"op", op(6)},
                           {"ver", Number32(1)},
                           {"chunk_pos", at},
                           {"start_time", when},
                           {"end_time", when},
                           {"count", Number32(1)}},
                          conn + Number32(1));
  }
  const std::uint64_t index_at = is_indexed ? kMagicBytes + kHeaderBytes + body.size() : 0;
  Fields fields = {{"op", op(3)},
                   {"index_pos", Number64(index_at)},
                   {"conn_count", Number32(is_indexed ? connections.size() : 0)},
                   {"chunk_count", Number32(is_indexed ? messages.size() : 0)}};
  if (!encryptor.empty()) fields.emplace_back("encryptor", encryptor);
  const std::string head = Block(header(fields));
  return "#ROSBAG V2.0\n" + head + Block(std::string(kHeaderBytes - head.size() - 4, ' ')) + body +
         (is_indexed ? connection_records + chunk_infos : "");
}

// kLooseEnd: the second half of the messages lies behind the chunks.
enum class McapForm { kChunked, kWithoutIndex, kWithoutChunks, kLooseEnd };

// An MCAP file of CDR (or of ROS 1); its chunks hold one message each.
inline std::string McapBytes(const std::vector<BagMessage>& messages, const std::string& how = "",
                             McapForm form = McapForm::kChunked, bool is_ros1 = false) {
  const auto record = [](char op, const std::string& data) { return op + Number64(data.size()) + data; };
  const auto number16 = [](std::uint64_t value) { return Number64(value).substr(0, 2); };
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string body = magic + record(1, Block(is_ros1 ? "ros1" : "ros2") + Block("test"));
  std::map<std::string, std::uint64_t> ids;
  std::map<std::uint64_t, std::uint64_t> counts;
  std::string definitions, chunk_indexes;
  std::size_t done = 0, chunks = 0;
  for (const BagMessage& message : messages) {
    const auto [id, is_new] = ids.try_emplace(message.topic, ids.size() + 1);
    std::string type = message.type;
    if (!is_ros1) type.replace(type.find('/'), 1, "/msg/");
    const std::string definition =
        record(3, number16(id->second) + Block(type) + Block(is_ros1 ? "ros1msg" : "ros2msg") +
                      Block(DefinitionText(message.type, is_ros1, message.definition))) +
        record(4, number16(id->second) + number16(id->second) + Block(message.topic) +
                      Block(is_ros1 ? "ros1" : "cdr") + Block(""));
    if (is_new) definitions += definition;
    ++counts[id->second];
    const std::string when = Number64(static_cast<std::uint64_t>(std::llround(1e9 * message.receive_s)));
    const std::string records = (is_new ? definition : "") +
                                record(5, number16(id->second) + Number32(0) + when + when + message.bytes);
    if (form == McapForm::kWithoutChunks || (form == McapForm::kLooseEnd && done++ >= messages.size() / 2)) {
      body += records;
      continue;
    }
    const std::string packed = Pack(how, records);
    const std::string chunk = record(6, when + when + Number64(records.size()) + Number32(0) + Block(how) +
                                            Number64(packed.size()) + packed);
    chunk_indexes += record(8, when + when + Number64(body.size()) + Number64(chunk.size()) +
                                   Block(number16(id->second) + Number64(0)) + Number64(0) + Block(how) +
                                   Number64(packed.size()) + Number64(records.size()));
    body += chunk;
    ++chunks;
  }
  body += record(15, Number32(0));
  const std::uint64_t summary_at = body.size();
  std::string by_channel;
  for (const auto& [id, count] : counts) by_channel += number16(id) + Number64(count);
  if (form == McapForm::kWithoutIndex) return body + record(2, std::string(20, '\0')) + magic;
  const std::string statistics = Number64(messages.size()) + number16(ids.size()) + Number32(ids.size()) +
                                 Number32(0) + Number32(0) + Number32(chunks) + Number64(0) + Number64(0) +
                                 Block(by_channel);
  return body + definitions + chunk_indexes + record(11, statistics) +
         record(2, Number64(summary_at) + Number64(0) + Number32(0)) + magic;
}

// A file of rosbag2's SQLite storage. `has_definitions`: as Iron and later write them.
inline void WriteSqliteBag(const std::string& path, const std::vector<BagMessage>& messages,
                           bool has_definitions) {
  sqlite3* db = nullptr;
  CAIRN_DEMAND(sqlite3_open(path.c_str(), &db) == SQLITE_OK, path);
  const auto run = [&](const std::string& sql, const std::vector<std::string>& values) {
    sqlite3_stmt* statement = nullptr;
    CAIRN_DEMAND(sqlite3_prepare_v2(db, sql.c_str(), -1, &statement, nullptr) == SQLITE_OK,
                 sqlite3_errmsg(db));
    for (std::size_t i = 0; i < values.size(); ++i)
      sqlite3_bind_blob(statement, static_cast<int>(i) + 1, values[i].data(),
                        static_cast<int>(values[i].size()), SQLITE_STATIC);
    CAIRN_DEMAND(sqlite3_step(statement) == SQLITE_DONE, sqlite3_errmsg(db));
    sqlite3_finalize(statement);
  };
  run("PRAGMA synchronous = OFF", {});
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)",
      {});
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
      "data BLOB NOT NULL)",
      {});
  if (has_definitions)
    run("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT "
        "NOT "
        "NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL)",
        {});
  std::map<std::string, std::size_t> ids;
  for (const BagMessage& message : messages) {
    const auto [id, is_new] = ids.try_emplace(message.topic, ids.size() + 1);
    std::string type = message.type;
    type.replace(type.find('/'), 1, "/msg/");
    if (is_new)
      run("INSERT INTO topics VALUES(" + std::to_string(id->second) +
              ", CAST(?1 AS TEXT), CAST(?2 AS TEXT), 'cdr', '')",
          {message.topic, type});
    if (is_new && has_definitions)
      run("INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, "
          "type_description_hash) VALUES(CAST(?1 AS TEXT), 'ros2msg', CAST(?2 AS TEXT), '')",
          {type, DefinitionText(message.type, false, message.definition)});
    run("INSERT INTO messages(topic_id, timestamp, data) VALUES(" + std::to_string(id->second) + ", " +
            std::to_string(std::llround(1e9 * message.receive_s)) + ", ?1)",
        {message.bytes});
  }
  sqlite3_close(db);
}

// A robot that goes a metre in ten steps, with a laser.
inline std::vector<BagMessage> SmallDrive(Encoder::To to, double variance = 0) {
  std::vector<BagMessage> messages;
  for (int i = 0; i <= 10; ++i) {
    const double at = 1000 + 0.5 * i;
    messages.push_back(
        {"/odom", "nav_msgs/Odometry", at, OdometryMessage(to, at, 0.1 * i, 0.01 * i, variance)});
    messages.push_back(
        {"/scan", "sensor_msgs/LaserScan", at + 0.01, ScanMessage(to, at, {1, 2.5F, 3, 30, 0.05F})});
  }
  return messages;
}

}  // namespace cairn::datasets::bag
