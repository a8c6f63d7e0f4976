#include "datasets/bag/in_child.h"

#include <csignal>

#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

class BagInChildTest : public ImportBagTest {};

TEST_F(BagInChildTest, BringsBackTheSameLogAndReport) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages[4].bytes = bag::OdometryMessage(To::kRos1, 0, 0.2, 0);
  for (bag::BagMessage& message : messages)
    if (message.topic == "/scan")
      message.bytes = bag::ScanMessage(To::kRos1, message.receive_s - 3, {1, 2, 3, 4, 5});
  options_.skip_bad = true;
  const ImportReport here = Import(messages);
  Blob log;
  const Result<ImportReport> there = ImportBagInChild(options_, &log);
  ASSERT_TRUE(there.ok()) << there.status().message();
  EXPECT_EQ(log.ContentHash(), log_.ContentHash());
  EXPECT_EQ(there.value().read, here.read);
  EXPECT_EQ(there.value().skipped, (std::map<std::string, std::int64_t>{{"no time in its header", 1}}));
  EXPECT_EQ(there.value().dropped, here.dropped);
  EXPECT_EQ(there.value().warnings, here.warnings);
  EXPECT_FALSE(here.warnings.empty());
  EXPECT_FALSE(here.dropped.empty());
  EXPECT_EQ(there.value().unit_doubts, here.unit_doubts);
  EXPECT_EQ(there.value().robots, 1);
  EXPECT_EQ(there.value().controls, here.controls);
  EXPECT_EQ(there.value().scans, here.scans);
  EXPECT_GT(here.scans, 0);
}

TEST_F(BagInChildTest, ARefusalSaysTheSame) {
  options_.odometry = "/none";
  const std::string here = Refusal(bag::SmallDrive(To::kRos1));
  Blob log;
  const Result<ImportReport> there = ImportBagInChild(options_, &log);
  ASSERT_FALSE(there.ok());
  EXPECT_EQ(there.status().code(), Code::kRefused);
  EXPECT_EQ(there.status().message(), here);
  EXPECT_TRUE(log.fields().empty());
}

#ifndef CAIRN_SANITIZED
TEST_F(BagInChildTest, ABagThatTakesMoreMemoryThanItMayIsRefused) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages.push_back({"/blob", "a/Blob", 1010, std::string(std::size_t{64} << 20, 'x'), "uint8[] data\n"});
  options_.files = {folder_.Put("packed.bag", bag::Ros1Bytes(messages, "lz4", false))};
  options_.memory_mb = 16;
  Blob log;
  const Result<ImportReport> made = ImportBagInChild(options_, &log);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.status().code(), Code::kRefused);
  ExpectContains(made.status().message(), "packed.bag: not read: it takes more than the 16 MB of memory");
  ExpectContains(made.status().message(), "--max-memory-mb");
  options_.memory_mb = 0;
  EXPECT_TRUE(ImportBagInChild(options_, &log).ok());
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
