#include "datasets/bag/in_child.h"

#include <cmath>
#include <csignal>

#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

class BagInChildTest : public ImportBagTest {
 protected:
  // What is told of a log is its hash.
  Result<StoredImport> ImportInChild() {
    return ImportBagInChild(options_, [](const Blob& log, const ImportReport&) -> Result<std::string> {
      return log.ContentHash().Hex();
    });
  }
};

TEST_F(BagInChildTest, BringsBackTheSameLogAndReport) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages[4].bytes = bag::OdometryMessage(To::kRos1, 0, 0.2, 0);
  for (bag::BagMessage& message : messages)
    if (message.topic == "/scan")
      message.bytes = bag::ScanMessage(To::kRos1, message.receive_s - 3, {1, 2, 3, 4, 5});
  options_.skip_bad = true;
  const ImportReport here = Import(messages);
  const Result<StoredImport> stored = ImportInChild();
  ASSERT_TRUE(stored.ok()) << stored.status().message();
  EXPECT_EQ(stored.value().told, log_.ContentHash().Hex());
  const ImportReport& there = stored.value().report;
  EXPECT_EQ(there.read, here.read);
  EXPECT_EQ(there.skipped, (std::map<std::string, std::int64_t>{{"no time in its header", 1}}));
  EXPECT_EQ(there.dropped, here.dropped);
  EXPECT_EQ(there.warnings, here.warnings);
  EXPECT_FALSE(here.warnings.empty());
  EXPECT_FALSE(here.dropped.empty());
  EXPECT_EQ(there.unit_doubts, here.unit_doubts);
  EXPECT_EQ(there.robots, 1);
  EXPECT_EQ(there.controls, here.controls);
  EXPECT_EQ(there.scans, here.scans);
  EXPECT_GT(here.scans, 0);
}

// Two lasers, of which one says how bright; scans before the odometry begins are left out, and some come
// late.
TEST_F(BagInChildTest, ALogOfFilesHasTheSameBitsAsOneInMemory) {
  constexpr std::size_t kBeams = 25;
  std::vector<bag::BagMessage> messages;
  for (int i = 0; i < 12'000; ++i) {
    const double now_s = 1000 + 0.01 * i, at_s = now_s - (i % 7 == 3 ? 0.05 : 0);
    if (i >= 20 && i % 50 == 0)
      messages.push_back(
          {"/odom", "nav_msgs/Odometry", now_s, bag::OdometryMessage(To::kRos1, now_s, 0.001 * i, 0)});
    std::vector<float> ranges, intensities;
    for (std::size_t b = 0; b < kBeams; ++b) {
      ranges.push_back(0.05F * static_cast<float>((b * 37 + static_cast<std::size_t>(i)) % 500));
      intensities.push_back(static_cast<float>(b));
    }
    for (const char* topic : {"/front", "/back"})
      messages.push_back(
          {topic, "sensor_msgs/LaserScan", now_s,
           bag::ScanMessage(To::kRos1, at_s, ranges, "base_link",
                            *(topic + 1) == 'b' && i > 30 ? intensities : std::vector<float>())});
  }
  options_.scans = {"/front", "/back"};
  const ImportReport here = Import(messages);
  EXPECT_GT(here.dropped.at("scan outside the odometry's time"), 0);
  options_.folder = folder_ / "";
  Blob log;
  const ImportReport there = ImportBag(options_, &log);
  EXPECT_TRUE(log.at("robot/0/laser/range_m").is_in_file());
  EXPECT_TRUE(log.at("robot/0/laser2/intensity").is_in_file());
  EXPECT_FALSE(log.Has("robot/0/laser/intensity"));
  EXPECT_EQ(log.ContentHash(), log_.ContentHash());
  EXPECT_EQ(there.read, here.read);
  const std::string unanswered = "readings of laser without an answer within its reach";
  std::int64_t none = 0;
  for (const double range : log.Get<double>("robot/0/laser/range_m")) none += std::isnan(range) ? 1 : 0;
  EXPECT_EQ(there.read.at(unanswered), none);
}

TEST_F(BagInChildTest, ADiskThatDoesNotTakeTheScansIsNamed) {
  options_.files = {folder_.Put("drive.bag", bag::Ros1Bytes(bag::SmallDrive(To::kRos1)))};
  const Result<StoredImport> full =
      ImportBagInChild(options_, [](const Blob&, const ImportReport&) -> Result<std::string> {
        throw NotStored{Status(Code::kNoSpace, "/there: cannot write what is read")};
      });
  ASSERT_FALSE(full.ok());
  EXPECT_EQ(full.status().code(), Code::kNoSpace);
  EXPECT_EQ(full.status().message(), "/there: cannot write what is read");
}

TEST_F(BagInChildTest, ARefusalSaysTheSame) {
  options_.odometry = "/none";
  const std::string here = Refusal(bag::SmallDrive(To::kRos1));
  const Result<StoredImport> there = ImportInChild();
  ASSERT_FALSE(there.ok());
  EXPECT_EQ(there.status().code(), Code::kRefused);
  EXPECT_EQ(there.status().message(), here);
}

#ifndef CAIRN_SANITIZED
TEST_F(BagInChildTest, ABagThatTakesMoreMemoryThanItMayIsRefused) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages.push_back({"/blob", "a/Blob", 1010, std::string(std::size_t{64} << 20, 'x'), "uint8[] data\n"});
  options_.files = {folder_.Put("packed.bag", bag::Ros1Bytes(messages, "lz4", false))};
  options_.memory_mb = 16;
  const Result<StoredImport> made = ImportInChild();
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.status().code(), Code::kRefused);
  ExpectContains(made.status().message(), "packed.bag: not read: it takes more than the 16 MB of memory");
  ExpectContains(made.status().message(), "--max-memory-mb");
  options_.memory_mb = 0;
  EXPECT_TRUE(ImportInChild().ok());
}

// Poses, turns of a gyro, scans and transforms of a long drive, in files so small that what this process
// frees of one is no help to the child.
TEST_F(BagInChildTest, MemoryDoesNotGrowWithTheDrive) {
  constexpr int kFiles = 24, kSteps = 2'500, kMemoryMb = 16;
  for (int file = 0; file < kFiles; ++file) {
    std::vector<bag::BagMessage> messages;
    for (int i = file * kSteps; i < (file + 1) * kSteps; ++i) {
      const double at_s = 1000 + 0.02 * i;
      const auto add = [&](const char* topic, const char* type, std::string bytes) {
        messages.push_back({topic, type, at_s, std::move(bytes)});
      };
      add("/odom", "nav_msgs/Odometry", bag::OdometryMessage(To::kRos1, at_s, 0.01 * i, 0));
      add("/imu", "sensor_msgs/Imu", bag::ImuMessage(To::kRos1, at_s, 0));
      add("/tf", "tf2_msgs/TFMessage", bag::TransformMessage(To::kRos1, at_s, "map", "odom", 0, 1e-6 * i));
      add("/scan", "sensor_msgs/LaserScan", bag::ScanMessage(To::kRos1, at_s, std::vector<float>(12, 5)));
    }
    options_.files.push_back(folder_.Put("drive_" + std::to_string(file) + ".mcap",
                                         bag::McapBytes(messages, "", bag::McapForm::kWithoutChunks, true)));
  }
  options_.gyro = "/imu";
  options_.truth = "tf";
  options_.memory_mb = 4 * kMemoryMb;
  const Result<StoredImport> in_memory = ImportInChild();
  ASSERT_FALSE(in_memory.ok()) << "the drive is so short that this test shows nothing";
  ExpectContains(in_memory.status().message(), "more than the 64 MB of memory");
  options_.folder = folder_ / "";
  options_.memory_mb = kMemoryMb;
  const Result<StoredImport> made = ImportInChild();
  ASSERT_TRUE(made.ok()) << made.status().message();
  EXPECT_EQ(made.value().report.scans, kFiles * kSteps);
}
#endif

TEST_F(BagInChildTest, ACrashIsAStatusAndALongTextComesWhole) {
  const std::string path = folder_.Put("drive.bag", bag::Ros1Bytes(bag::SmallDrive(To::kRos1)));
  const auto text = InspectBagInChild(
      path, [](const BagInspection& bag) { return std::string(3 << 20, 'x') + bag.topics[0].name; });
  ASSERT_TRUE(text.ok()) << text.status().message();
  EXPECT_EQ(text.value().size(), (3U << 20) + 5);
  EXPECT_TRUE(text.value().ends_with("x/odom"));
#ifndef CAIRN_SANITIZED
  // Touches none of it.
  const auto large =
      InspectBagInChild(path, [](const BagInspection&) { return std::string(std::size_t{4} << 30, 'x'); });
  ASSERT_FALSE(large.ok());
  EXPECT_EQ(large.status().code(), Code::kRefused);
  ExpectContains(large.status().message(), "drive.bag: not read: it takes more than the ");
  const auto crash = InspectBagInChild(path, [](const BagInspection&) {
    std::signal(SIGSEGV, SIG_DFL);
    ::raise(SIGSEGV);
    return std::string();
  });
  ASSERT_FALSE(crash.ok());
  EXPECT_EQ(crash.status().code(), Code::kCorrupt);
  ExpectContains(crash.status().message(), "drive.bag: damaged; its reader crashed while reading it");
#endif
}

}  // namespace
}  // namespace cairn::datasets
