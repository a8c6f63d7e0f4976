#include "datasets/bag/inspect_bag.h"

#include <algorithm>

#include "datasets/bag/import_bag.h"
#include "datasets/bag/testing_bag.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

using bag::Encoder;

TEST(InspectBag, ListsTopicsWithWhatCairnCanDoWithThem) {
  const TestFolder folder;
  auto messages = bag::SmallDrive(Encoder::To::kRos1);
  messages.push_back({"/cmd_vel", "geometry_msgs/Twist", 1002, std::string(48, '\0')});
  messages.push_back({"/tf", "tf2_msgs/TFMessage", 1004,
                      bag::TransformMessage(Encoder::To::kRos1, 1004, "/odom", "base_link", 0, 0)});
  messages.push_back({"/heat", "sensor_msgs/Temperature", 1004, "short", "float64 temperature\n"});
  messages.erase(messages.begin() + 4);  // of /odom
  const std::string path = folder.Put("drive.bag", bag::Ros1Bytes(messages, "bz2"));
  const BagInspection bag = InspectBag(path);
  EXPECT_EQ(bag.what, "a ROS 1 bag");
  EXPECT_EQ(bag.first_s, 1000);
  EXPECT_NEAR(bag.length_s, 5.01, 1e-9);
  ASSERT_EQ(bag.topics.size(), 5U);
  EXPECT_EQ(bag.topics[0].name, "/cmd_vel");
  EXPECT_EQ(bag.topics[1].as, "") << bag.topics[1].name;
  const BagTopic& odometry = bag.topics[2];
  EXPECT_EQ(odometry.messages, 10U);
  EXPECT_NEAR(odometry.rate_hz, 2, 0.01);
  EXPECT_NEAR(odometry.gap_s.value_or(0), 1, 1e-9);
  EXPECT_EQ(odometry.frames, (std::vector<std::string>{"odom"}));
  EXPECT_EQ(bag.topics[4].frames, (std::vector<std::string>{"odom > base_link"}));
  EXPECT_TRUE(bag.remarks.empty()) << "what is not used is not read: " << bag.remarks.front();
  const std::string text = BagText(bag);
  ExpectContains(text,
                 "/odom nav_msgs/Odometry: 10 messages, 2.0 Hz, longest gap 1.00 s; frame odom; as odometry");
  ExpectContains(text, "/heat sensor_msgs/Temperature: 1 messages; not used");
}

TEST(InspectBag, SaysWhatIsWrong) {
  const TestFolder folder;
  const std::string whole = bag::McapBytes(bag::SmallDrive(Encoder::To::kCdr));
  const BagInspection bag = InspectBag(folder.Put("cut.mcap", whole.substr(0, whole.size() / 3)));
  ASSERT_EQ(bag.remarks.size(), 2U) << bag.remarks.front();
  ExpectContains(bag.remarks[0], "the file ends within it");
  ExpectContains(bag.remarks[1], "no summary");
  BagInspection none = InspectBag(folder.Put("none.mcap", whole.substr(0, 200)));
  none.command = "cairn import bag";
  EXPECT_EQ(none.topics.size(), 0U);
  EXPECT_EQ(BagText(none).find("try:"), std::string::npos);
  const std::vector<bag::BagMessage> heat = {
      {"/heat", "sensor_msgs/Temperature", 1004, std::string(8, 0), "float64 temperature\n"}};
  BagInspection useless = InspectBag(folder.Put("heat.bag", bag::Ros1Bytes(heat)));
  useless.command = "cairn import bag";
  EXPECT_EQ(useless.topics.size(), 1U);
  EXPECT_EQ(BagText(useless).find("try:"), std::string::npos) << "there is nothing to import";
  ExpectContains(BagText(useless), "nothing in it says how a robot moved");
}

TEST(InspectBag, WhatItQuotesEndsNoLine) {
  const TestFolder folder;
  const std::string topic = "/odom\ntry: \x1b[31mthis";
  const std::string bytes = bag::Ros1Bytes({{topic, "nav_msgs/Odometry", 1000, "short"}}, "none");
  const BagInspection bag = InspectBag(folder.Put("drive.bag", bytes));
  ASSERT_EQ(bag.remarks.size(), 1U);
  ExpectContains(bag.remarks[0], topic + ": the message is shorter");
  const std::string text = BagText(bag);
  EXPECT_EQ(std::ranges::count(text, '\n'), 3) << text;
  EXPECT_EQ(text.find('\x1b'), std::string::npos) << text;
  ExpectContains(text, "this: the message is shorter");
}

TEST(InspectBag, FieldsOfAllTopicsAreBounded) {
  const TestFolder folder;
  std::string text = bag::DefinitionText("nav_msgs/Odometry", false);
  std::string many;
  for (int i = 0; i < 9000; ++i) many += "bool a" + std::to_string(i) + "\n";
  std::vector<bag::BagMessage> messages;
  for (int i = 0; i < 230; ++i)
    messages.push_back({"/odom" + std::to_string(i), "nav_msgs/Odometry", 1000, "", many + text});
  const std::string path =
      folder.Put("many.mcap", bag::McapBytes(messages, "zstd", bag::McapForm::kWithoutIndex));
  const std::string why = "many.mcap: topics of more than 2,000,000 fields, counted in all types";
  ExpectContains(InputErrorOf([&] { InspectBag(path); }), why);
  Blob log;
  BagImportOptions options;
  options.files = {path};
  options.odometry = "/odom0";
  ExpectContains(InputErrorOf([&] { ImportBag(options, &log); }), why);
}

}  // namespace
}  // namespace cairn::datasets
