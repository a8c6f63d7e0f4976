#include "datasets/bag/import_bag.h"

#include <cmath>
#include <filesystem>
#include <numbers>

#include "datasets/bag/container.h"
#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

using bag::BagMessage;
using bag::McapForm;

TEST_F(ImportBagTest, AllContainersHoldTheSameDrive) {
  const auto ros1 = bag::SmallDrive(To::kRos1), cdr = bag::SmallDrive(To::kCdr),
             big = bag::SmallDrive(To::kBigCdr);
  for (const char* how : {"none", "bz2", "lz4"})
    for (const bool is_indexed : {true, false}) {
      Import(bag::Ros1Bytes(ros1, how, is_indexed));
      ExpectSmallDrive(std::string("bag of ") + how);
    }
  for (const char* how : {"", "lz4", "zstd"})
    for (const McapForm form :
         {McapForm::kChunked, McapForm::kWithoutIndex, McapForm::kWithoutChunks, McapForm::kLooseEnd}) {
      Import(bag::McapBytes(cdr, how, form), "drive.mcap");
      ExpectSmallDrive(std::string("mcap of ") + how);
    }
  Import(bag::McapBytes(big), "drive.mcap");
  ExpectSmallDrive("big-endian");
  Import(bag::McapBytes(ros1, "", McapForm::kChunked, true), "drive.mcap");
  ExpectSmallDrive("ROS 1 in MCAP");
  for (const bool has_definitions : {true, false}) {
    const std::string path = folder_ / (has_definitions ? "new.db3" : "old.db3");
    bag::WriteSqliteBag(path, cdr, has_definitions);
    options_.files = {path};
    ImportBag(options_, &log_);
    ExpectSmallDrive(path);
  }
}

TEST_F(ImportBagTest, PartsOfADriveAreReadInTheirOrder) {
  const auto whole = bag::SmallDrive(To::kRos1);
  const std::vector<BagMessage> first(whole.begin(), whole.begin() + 10),
      second(whole.begin() + 10, whole.end());
  options_.files = {folder_.Put("b.bag", bag::Ros1Bytes(second)),
                    folder_.Put("a.bag", bag::Ros1Bytes(first))};
  ImportBag(options_, &log_);
  ExpectSmallDrive("two files");
  const std::string folder = folder_ / "rosbag2";
  std::filesystem::create_directory(folder);
  const auto cdr = bag::SmallDrive(To::kCdr);
  bag::WriteSqliteBag(folder + "/a_0.db3", {cdr.begin(), cdr.begin() + 12}, false);
  bag::WriteSqliteBag(folder + "/a_1.db3", {cdr.begin() + 12, cdr.end()}, false);
  options_.files = {folder};
  ImportBag(options_, &log_);
  ExpectSmallDrive("a folder of rosbag2");
}

TEST_F(ImportBagTest, ABagThatIsCutOffIsReadAsFarAsItGoesWhereAsked) {
  const std::string whole = bag::Ros1Bytes(bag::SmallDrive(To::kRos1), "lz4", false);
  const std::string cut = whole.substr(0, whole.size() - 300);
  const std::string refusal = Refusal(cut);
  ExpectContains(refusal, "after message 11 of /odom");
  ExpectContains(refusal, "the file ends within it");
  ExpectContains(refusal, "--skip-bad");
  options_.skip_bad = true;
  const ImportReport report = Import(cut);
  EXPECT_EQ(report.scans, 10);
  EXPECT_EQ(report.skipped.at("part of a file that cannot be read"), 1);
}

TEST_F(ImportBagTest, SensorsSitWhereTfSays) {
  auto messages = bag::SmallDrive(To::kRos1);
  for (BagMessage& message : messages)
    if (message.topic == "/scan")
      message.bytes = bag::ScanMessage(To::kRos1, message.receive_s, {1, 2, 3, 4, 5}, "/laser");
  ExpectContains(Refusal(messages),
                 "/scan is of the frame 'laser', and no tf says where that is on 'base_link'");
  ExpectContains(Refusal(messages), "--mount /scan=X,Y,DEGREES");
  messages.push_back({"/tf_static", "tf2_msgs/TFMessage", 1000,
                      bag::TransformMessage(To::kRos1, 0, "mast", "laser", 0.2, 0, true)});
  messages.push_back(
      {"/tf", "tf/tfMessage", 1000,
       bag::TransformMessage(To::kRos1, 1000, "base_link", "mast", 0.1, std::numbers::pi / 2)});
  Import(messages);
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_x_m")[0], 0.1, 1e-12);
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_y_m")[0], 0.2, 1e-12);
  // Upside down, its first beam, to the right of it, is on the left.
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_heading_rad")[0], std::numbers::pi / 2 + 1, 1e-12);
  options_.mounts["/scan"] = {0.5, 0, 0};
  Import(messages);
  EXPECT_EQ(Column<double>("robot/0/laser/beam_x_m")[0], 0.5);
  options_.mounts["/scna"] = {0.5, 0, 0};
  ExpectContains(Refusal(messages), "--mount /scna: there is no such topic; the nearest: '/scan'");
}

// Of a scan that has none there is nothing; drivers that know none write zeros.
TEST_F(ImportBagTest, IntensitiesComeInWhereTheySaySomething) {
  auto messages = bag::SmallDrive(To::kRos1);
  const auto scans_with = [&](const std::vector<float>& first, const std::vector<float>& others) {
    bool is_first = true;
    for (BagMessage& message : messages) {
      if (message.topic != "/scan") continue;
      message.bytes = bag::ScanMessage(To::kRos1, message.receive_s, {1, 2, 3, 4, 5}, "base_link",
                                       is_first ? first : others);
      is_first = false;
    }
    Import(bag::Ros1Bytes(messages));
    return log_.Has("robot/0/laser/intensity");
  };
  EXPECT_FALSE(scans_with({}, {}));
  EXPECT_FALSE(scans_with({0, 0, 0, 0, 0}, {0, 0, 0, 0, 0}));
  ASSERT_TRUE(scans_with({}, {10, 20, 30, 40, 50}));
  const auto intensity = Column<float>("robot/0/laser/intensity");
  EXPECT_TRUE(std::isnan(intensity[4]));
  EXPECT_EQ(intensity[7], 30);
  EXPECT_EQ(log_.at("robot/0/laser/intensity").shape(), log_.at("robot/0/laser/range_m").shape());
}

TEST_F(ImportBagTest, WithoutATopicOfOdometryTheFrameThatMovesOnOdomCounts) {
  std::vector<BagMessage> messages;
  for (BagMessage& message : bag::SmallDrive(To::kRos1)) {
    if (message.topic == "/odom") {
      const int i = static_cast<int>(messages.size()) / 2;
      message = {"/tf", "tf2_msgs/TFMessage", message.receive_s,
                 bag::TransformMessage(To::kRos1, 1000 + 0.5 * i, "odom", "base_link", 0.1 * i, 0.01 * i)};
    }
    messages.push_back(message);
  }
  Import(messages);
  ExpectSmallDrive("tf");
  std::erase_if(messages, [](const BagMessage& message) { return message.topic == "/tf"; });
  ExpectContains(Refusal(messages), "no odometry: neither a topic of nav_msgs/Odometry nor a frame");
}

TEST_F(ImportBagTest, OfSeveralTopicsOneIsNamed) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages.push_back({"/odometry/filtered", "nav_msgs/Odometry", 1001, messages[0].bytes});
  const std::string refusal = Refusal(messages);
  ExpectContains(refusal,
                 "--odometry TOPIC chooses one of: /odom (11 of nav_msgs/Odometry), /odometry/filtered (1");
  options_.odometry = "/odm";
  ExpectContains(Refusal(messages), "there is no such topic; the nearest: '/odom'");
  options_.odometry = "/scan";
  ExpectContains(Refusal(messages), "that topic is of sensor_msgs/LaserScan; what serves: /odom");
  options_.odometry = "/odom";
  Import(messages);
  ExpectSmallDrive("chosen");
}

TEST_F(ImportBagTest, BadMessagesAreNamedAndSkippedWhereAsked) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages[4].bytes = bag::OdometryMessage(To::kRos1, 0, 0.2, 0);              // no time
  messages[6].bytes = bag::OdometryMessage(To::kRos1, 990, 0.3, 0);            // backwards
  messages[8].bytes = bag::OdometryMessage(To::kRos1, 1002, std::nan(""), 0);  // nowhere
  messages[9].bytes.pop_back();                                                // short
  messages[11].bytes += "x";                                                   // long
  messages[13].bytes = bag::ScanMessage(To::kRos1, 1003, {1, 2});              // other beams
  ExpectContains(Refusal(messages),
                 "drive.bag: message 3 of /odom: no time in its header: 0: recorded with /use_sim_time");
  options_.skip_bad = true;
  const ImportReport report = Import(messages);
  EXPECT_EQ(report.skipped,
            (std::map<std::string, std::int64_t>{{"no time in its header", 1},
                                                 {"time runs backwards", 1},
                                                 {"no pose", 1},
                                                 {"a message that does not match its definition", 2},
                                                 {"other beams than the topic's first scan", 1}}));
  EXPECT_EQ(report.scans, 8);
  for (std::size_t i = 2; i < messages.size(); ++i) messages[i].bytes.resize(20);
  ExpectContains(Refusal(messages), "--skip-bad leaves 2 of 22 messages, less than half");
}

TEST_F(ImportBagTest, BagsThatOverlapAreToldWhatToDoAndAskedAreReadOnce) {
  const auto messages = bag::SmallDrive(To::kRos1);
  const auto part = [&](std::size_t from, std::size_t end) {
    return bag::Ros1Bytes({messages.begin() + static_cast<std::ptrdiff_t>(from),
                           messages.begin() + static_cast<std::ptrdiff_t>(end)});
  };
  Import(messages);
  const Hash once = log_.ContentHash();
  options_.files = {folder_.Put("late.bag", part(8, messages.size())), folder_.Put("early.bag", part(0, 16))};
  const std::string refusal = InputErrorOf([&] { ImportBag(options_, &log_); });
  ExpectContains(refusal, "late.bag: message 1 of /odom: time runs backwards: ");
  ExpectContains(refusal,
                 "early.bag goes: the bags overlap, and --skip-bad takes what both hold from that one");
  options_.skip_bad = true;
  ImportBag(options_, &log_);
  EXPECT_EQ(log_.ContentHash(), once);
}

TEST_F(ImportBagTest, OfAnSqliteFileThatIsCutOffWhatIsThereIsRead) {
  std::vector<bag::BagMessage> messages;
  constexpr int kMessages = 400;
  for (int i = 0; i < kMessages; ++i) {
    const double at_s = 1000 + 0.1 * i;
    messages.push_back(
        {"/odom", "nav_msgs/Odometry", at_s, bag::OdometryMessage(To::kCdr, at_s, 0.01 * i, 0)});
    messages.push_back(
        {"/scan", "sensor_msgs/LaserScan", at_s, bag::ScanMessage(To::kCdr, at_s, {1, 2, 3, 4, 5})});
  }
  bag::WriteSqliteBag(folder_ / "whole.db3", messages, true);
  const std::string whole = FileText(folder_ / "whole.db3");
  options_.files = {folder_.Put("cut.db3", whole.substr(0, whole.size() * 3 / 4))};
  const std::string refusal = InputErrorOf([&] { ImportBag(options_, &log_); });
  ExpectContains(refusal, "cut.db3: after message ");
  ExpectContains(refusal, "--skip-bad");
  options_.skip_bad = true;
  const ImportReport report = ImportBag(options_, &log_);
  EXPECT_EQ(report.skipped, (std::map<std::string, std::int64_t>{{"part of a file that cannot be read", 1}}));
  EXPECT_GT(report.scans, kMessages / 2);
  EXPECT_LT(report.scans, kMessages);
  ExpectContains(report.warnings.front(), "cut.db3: the file ends within it");
}

TEST_F(ImportBagTest, ALeapOfAClockIsTheMessagesThatLeaps) {
  auto messages = bag::SmallDrive(To::kRos1);
  const auto odometry = [&](std::size_t i, double stamp_s) {
    messages[i].bytes = bag::OdometryMessage(To::kRos1, stamp_s, 0.1, 0);
  };
  ASSERT_EQ(messages[14].topic, "/odom");
  odometry(14, messages[14].receive_s + 5000);
  ExpectContains(Refusal(messages), "message 8 of /odom: time jumps ahead: 6003.5");
  ExpectContains(Refusal(messages), "the recorder's clock went on by 0.5");
  options_.skip_bad = true;
  EXPECT_EQ(Import(messages).skipped, (std::map<std::string, std::int64_t>{{"time jumps ahead", 1}}));
  // Clocks that never went together tell nothing: a recording of what was played fast.
  options_.skip_bad = false;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    messages[i].receive_s = 1000 + 0.01 * static_cast<double>(i);
    const double stamp_s = 1000 + 40 * static_cast<double>(i);
    messages[i].bytes = messages[i].topic == "/odom"
                            ? bag::OdometryMessage(To::kRos1, stamp_s, 0.1 * static_cast<double>(i), 0)
                            : bag::ScanMessage(To::kRos1, stamp_s, {1, 2, 3, 4, 5});
  }
  EXPECT_EQ(Import(messages).scans, 10);
}

TEST_F(ImportBagTest, WhatIsLeftWithoutOdometrySaysWhatWasSkipped) {
  auto messages = bag::SmallDrive(To::kRos1);
  for (bag::BagMessage& message : messages)
    if (message.topic == "/odom") message.bytes = bag::OdometryMessage(To::kRos1, 0, 0.2, 0);
  options_.skip_bad = true;
  const std::string refusal = Refusal(messages);
  ExpectContains(refusal, "there is neither odometry nor a pose in it (skipped: no time in its header (11))");
}

TEST_F(ImportBagTest, TimesAreTheRecordersWhereAsked) {
  auto messages = bag::SmallDrive(To::kRos1);
  for (BagMessage& message : messages)
    if (message.topic == "/scan")
      message.bytes = bag::ScanMessage(To::kRos1, message.receive_s - 3, {1, 2, 3, 4, 5});
  const ImportReport apart = Import(messages);
  ASSERT_FALSE(apart.warnings.empty());
  ExpectContains(apart.warnings.back(), "/scan: the clock of its headers is 3.0");
  options_.by_receipt = true;
  options_.from_s = 1;
  options_.until_s = 3.02;
  const ImportReport report = Import(messages);
  EXPECT_EQ(Column<double>("robot/0/laser/time_s").front(), 1001.01);
  EXPECT_EQ(report.scans, 4);
}

TEST_F(ImportBagTest, WhatIsNoBagOrIsEncryptedIsToldSo) {
  ExpectContains(Refusal("hello"), "no bag: neither of ROS 1");
  ExpectContains(Refusal(bag::Ros1Bytes(bag::SmallDrive(To::kRos1), "none", true, "rosbag/AesCbcEncryptor")),
                 "encrypted by 'rosbag/AesCbcEncryptor'");
  ExpectContains(Refusal("#ROSBAG V1.2\nwhatever"), "a bag of another version");
  ExpectContains(Refusal("#ROSRECORD V1.2\nwhatever"), "a bag of another version");
  ExpectContains(Refusal("\x28\xB5\x2F\xFDpacked"), "unzstd");
  ExpectContains(Refusal(""), "no bag");
  options_.files = {folder_ / "none.bag"};
  ExpectContains(InputErrorOf([&] { ImportBag(options_, &log_); }), "there is no such file");
}

TEST_F(ImportBagTest, CovariancesThatGrowWithTheWayAreTheHeadingsNoise) {
  std::vector<BagMessage> messages;
  for (int i = 0; i <= 20; ++i)
    messages.push_back({"/odom", "nav_msgs/Odometry", 1000.0 + i,
                        bag::OdometryMessage(To::kRos1, 1000 + i, 0.5 * i, 0, 0.0004 * 0.5 * i)});
  Import(messages);
  EXPECT_NEAR(log_.Scalar<double>("noise/heading_walk_rad_per_sqrt_m"), 0.02, 1e-9);
  for (BagMessage& message : messages)
    message.bytes = bag::OdometryMessage(To::kRos1, message.receive_s, message.receive_s - 1000, 0, 1e9);
  const ImportReport report = Import(messages);
  EXPECT_FALSE(log_.Has("noise/heading_walk_rad_per_sqrt_m"));
  ExpectContains(report.warnings.front(), "are of no heading");
}

TEST_F(ImportBagTest, OfADefinitionOneTextIsKept) {
  auto messages = bag::SmallDrive(To::kCdr);
  messages.push_back({"/odometry/filtered", "nav_msgs/Odometry", 1001, messages[0].bytes});
  for (const std::string& bytes : {bag::McapBytes(messages), bag::Ros1Bytes(messages)}) {
    const auto file = bag::OpenContainer(folder_.Put("two", bytes));
    ASSERT_EQ(file->channels().size(), 3U);
    EXPECT_GT(file->channels()[2].definition.size(), 100U);
    EXPECT_EQ(file->channels()[0].definition.data(), file->channels()[2].definition.data());
  }
}

TEST_F(ImportBagTest, DefinitionsAreBounded) {
  auto messages = bag::SmallDrive(To::kCdr);
  const auto pack = [&] { return bag::McapBytes(messages, "zstd", bag::McapForm::kWithoutIndex); };
  const auto note = [](std::size_t i, std::size_t bytes) {
    const std::string topic = "/note" + std::to_string(i);
    return BagMessage{topic, "a/Note", 1002, "", "#" + topic + std::string(bytes, 'a') + "\n"};
  };
  messages.push_back(note(0, 1'000'000));
  EXPECT_EQ(Import(pack()).scans, 11);
  messages.push_back(note(1, 1'100'000));
  ExpectContains(Refusal(pack()), "drive.bag: a definition of more than a megabyte");
  messages.pop_back();
  for (std::size_t i = 1; i < 70; ++i) messages.push_back(note(i, 1'000'000));
  ExpectContains(Refusal(pack()), "definitions of their types of more than 64 MiB in all");
}

TEST_F(ImportBagTest, NothingIsBetweenATimeAndAnEarlierOne) {
  options_.from_s = 3;
  options_.until_s = 1;
  ExpectContains(Refusal(bag::SmallDrive(To::kRos1)), "--from is later than --until");
  options_.until_s = {};
  options_.from_s = 500;
  ExpectContains(Refusal(bag::SmallDrive(To::kRos1)), "(of what lies between --from and --until)");
}

}  // namespace
}  // namespace cairn::datasets
