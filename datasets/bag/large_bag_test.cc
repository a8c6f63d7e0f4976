// What is read of a bag that is too large to be read.
#include <filesystem>
#include <fstream>

#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

using bag::Block;
using bag::Number32;
using bag::Number64;

// An MCAP file whose images are holes in it: of any size, in hardly any room.
class SparseMcap {
 public:
  explicit SparseMcap(const std::string& path) : path_(path), out_(path, std::ios::binary) {
    Write(std::string("\x89MCAP0\r\n", 8));
    Write(Record(1, Block("ros2") + Block("test")));
    for (const auto& [topic, type] : {std::pair{"/odom", "nav_msgs/msg/Odometry"},
                                      {"/scan", "sensor_msgs/msg/LaserScan"},
                                      {"/camera", "sensor_msgs/msg/CompressedImage"}}) {
      const std::string id = Id(topic);
      summary_ += Record(3, id + Block(type) + Block("ros2msg") + Block(DefinitionOf(type)));
      summary_ += Record(4, id + id + Block(topic) + Block("cdr") + Block(""));
    }
  }
  // One that holds the message, if there is one, and an image of so many bytes behind it.
  void AddChunk(const bag::BagMessage* message, std::uint64_t image_bytes) {
    const std::string when = Number64(std::uint64_t{1000} * 1'000'000'000);
    std::string records, channels = Id("/camera") + Number64(0);
    if (message != nullptr) {
      const auto at_ns = static_cast<std::uint64_t>(std::llround(1e9 * message->receive_s));
      records = Record(5, Id(message->topic) + Number32(0) + Number64(at_ns) + when + message->bytes);
      channels += Id(message->topic) + Number64(0);
      ++counts_[Id(message->topic)];
    }
    records += Head(5, kMessageHead + image_bytes) + Id("/camera") + Number32(0) + when + when;
    ++counts_[Id("/camera")];
    const std::uint64_t bytes = records.size() + image_bytes;
    const std::string head = when + when + Number64(bytes) + Number32(0) + Block("") + Number64(bytes);
    summary_ += Record(8, when + when + Number64(at_) + Number64(9 + head.size() + bytes) + Block(channels) +
                              Number64(0) + Block("") + Number64(bytes) + Number64(bytes));
    Write(Head(6, head.size() + bytes) + head + records);
    at_ += image_bytes;
    out_.seekp(static_cast<std::streamoff>(at_));
    ++chunks_;
  }
  void Close() {
    Write(Record(15, Number32(0)));
    const std::uint64_t summary_at = at_;
    std::uint64_t messages = 0;
    std::string counts;
    for (const auto& [id, count] : counts_) {
      counts += id + Number64(count);
      messages += count;
    }
    Write(summary_);
    Write(Record(11, Number64(messages) + std::string("\x03\x00", 2) + Number32(3) + Number32(0) +
                         Number32(0) + Number32(chunks_) + Number64(0) + Number64(0) + Block(counts)));
    Write(Record(2, Number64(summary_at) + Number64(0) + Number32(0)) + std::string("\x89MCAP0\r\n", 8));
    out_.close();
    ASSERT_EQ(std::filesystem::file_size(path_), at_) << "the file system takes no file of this size";
  }

 private:
  static constexpr std::uint64_t kMessageHead = 22;
  static std::string Id(const std::string& topic) {
    return {static_cast<char>(topic == "/odom" ? 1 : topic == "/scan" ? 2 : 3), '\0'};
  }
  static std::string DefinitionOf(const std::string& type) {
    if (type.ends_with("Image")) return "uint8[] data\n";
    return bag::DefinitionText(type.ends_with("Odometry") ? "nav_msgs/Odometry" : "sensor_msgs/LaserScan",
                               false);
  }
  static std::string Head(char op, std::uint64_t bytes) { return op + Number64(bytes); }
  static std::string Record(char op, const std::string& data) { return Head(op, data.size()) + data; }
  void Write(const std::string& bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    at_ += bytes.size();
  }

  std::string path_;
  std::ofstream out_;
  std::uint64_t at_ = 0, chunks_ = 0;
  std::string summary_;
  std::map<std::string, std::uint64_t> counts_;
};

// By this process, of files and all else.
std::uint64_t BytesRead() {
  std::ifstream io("/proc/self/io");
  std::string name;
  std::uint64_t bytes = 0;
  io >> name >> bytes;
  CAIRN_DEMAND(name == "rchar:", "no /proc/self/io");
  return bytes;
}

TEST_F(ImportBagTest, OfFiftyGigabytesThoseChunksAloneAreReadThatHoldWhatIsWanted) {
  const std::string path = folder_ / "large.mcap";
  SparseMcap file(path);
  for (const bag::BagMessage& message : bag::SmallDrive(To::kCdr)) {
    file.AddChunk(&message, 100'000'000);
    file.AddChunk(nullptr, 2'200'000'000);
  }
  file.Close();
  ASSERT_GT(std::filesystem::file_size(path), 50'000'000'000U);
  options_.files = {path};
  const std::uint64_t before = BytesRead();
  ImportBag(options_, &log_);
  EXPECT_LT(BytesRead() - before, 1'000'000U);
  ExpectSmallDrive("fifty gigabytes");
}

TEST_F(ImportBagTest, ScansStandInTheOrderOfTheirTimesWithoutThoseThatHaveNoPose) {
  auto messages = bag::SmallDrive(To::kRos1);
  const auto add = [&](double at_s, float range_m, double received_s) {
    messages.push_back({"/scan", "sensor_msgs/LaserScan", received_s,
                        bag::ScanMessage(To::kRos1, at_s, {range_m, 2, 3, 4, 5})});
  };
  add(1004.75, 8, 1006);
  add(1004.25, 7, 1006.1);
  add(1005.5, 9, 1006.2);
  const ImportReport report = Import(messages);
  EXPECT_EQ(report.dropped.at("scan outside the odometry's time"), 1);
  const auto time_s = Column<double>("robot/0/laser/time_s"),
             range_m = Column<double>("robot/0/laser/range_m");
  ASSERT_EQ(time_s.size(), 13U);
  ASSERT_EQ(range_m.size(), 5 * 13U);
  EXPECT_TRUE(std::ranges::is_sorted(time_s));
  const auto first_at = [&](double at_s) {
    return range_m[5 * static_cast<std::size_t>(std::ranges::find(time_s, at_s) - time_s.begin())];
  };
  EXPECT_EQ(first_at(1004.0), 1);
  EXPECT_EQ(first_at(1004.25), 7);
  EXPECT_EQ(first_at(1004.5), 1);
  EXPECT_EQ(first_at(1004.75), 8);
}

}  // namespace
}  // namespace cairn::datasets
