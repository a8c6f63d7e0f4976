#include <numbers>

#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

using bag::BagMessage;
using Points = std::vector<std::array<float, 3>>;

class BagCloudTest : public ImportBagTest {
 protected:
  // The small drive with clouds instead of scans.
  static std::vector<BagMessage> Drive(To to, const Points& points, const std::string& frame = "base_link") {
    std::vector<BagMessage> messages = bag::SmallDrive(to);
    for (BagMessage& message : messages)
      if (message.topic == "/scan")
        message = {"/points", "sensor_msgs/PointCloud2", message.receive_s,
                   bag::CloudMessage(to, message.receive_s, points, frame)};
    return messages;
  }
  void Choose(const std::string& cut) {
    options_.scans = {"/points"};
    options_.cloud = cut;
  }
};

TEST_F(BagCloudTest, WhatLiesBetweenTwoHeightsIsAScan) {
  const float nan = std::nanf("");
  const Points points = {{2, 0.01F, 0.3F},  {1, 0.005F, 0.1F}, {3, 0.015F, 0.4F}, {-0.01F, 4, 0.3F},
                         {-0.1F, 50, 0.3F}, {-1, -0.01F, 5},   {nan, nan, nan}};
  Choose("0.2,0.5,20");
  for (const To to : {To::kRos1, To::kCdr}) {
    const auto messages = Drive(to, points);
    to == To::kRos1 ? Import(messages) : Import(bag::McapBytes(messages), "drive.mcap");
    const auto heading = Column<double>("robot/0/laser/beam_heading_rad");
    const auto range = Column<double>("robot/0/laser/range_m");
    ASSERT_EQ(heading.size(), 3U) << "ahead, to the left, behind: nothing is known of other directions";
    EXPECT_EQ(range.size(), 3 * 10U) << "the last one comes after the odometry";
    const double half_sector = std::numbers::pi / 720;
    EXPECT_NEAR(heading[0], std::atan2(-0.01, -1), half_sector);
    EXPECT_TRUE(std::isnan(range[0])) << "too high";
    EXPECT_NEAR(heading[1], std::atan2(0.01, 2), half_sector);
    EXPECT_NEAR(range[1], 2, 1e-3) << "the nearest of the two; one is too low";
    EXPECT_NEAR(heading[2], std::atan2(4, -0.01), half_sector);
    EXPECT_NEAR(range[2], 4, 1e-3);
    EXPECT_EQ(log_.Scalar<double>("robot/0/laser/max_range_m"), 20);
  }
}

TEST_F(BagCloudTest, PointsAreTurnedAsTheirSensorIsMounted) {
  // A camera that looks ahead: its z axis; what its y axis says is height, downwards. tf comes last.
  auto messages = Drive(To::kRos1, {{-1, 0.3F, 2}, {-1, 0.7F, 1}}, "camera");
  bag::Encoder mount(To::kRos1);
  mount.Put<std::uint32_t>(1)
      .Header(0, "base_link")
      .Text("camera")
      .Doubles({0.2, 0, 0.6, -0.5, 0.5, -0.5, 0.5});
  messages.push_back({"/tf_static", "tf2_msgs/TFMessage", 1006, mount.text()});
  Choose("0.2,0.5,10");
  Import(messages);
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_x_m")[0], 0.2, 1e-9);
  const auto heading = Column<double>("robot/0/laser/beam_heading_rad");
  const auto range = Column<double>("robot/0/laser/range_m");
  ASSERT_EQ(heading.size(), 2U);
  EXPECT_NEAR(heading[0], std::atan2(1, 2), 0.005);
  EXPECT_NEAR(range[0], std::sqrt(5), 1e-3);
  EXPECT_TRUE(std::isnan(range[1])) << "below the lower height";
  messages.pop_back();
  ExpectContains(Refusal(messages),
                 "/points is of the frame 'camera', and no tf says where that is on 'base_link'");
}

TEST_F(BagCloudTest, CloudsThatCannotBeUsedAreNamed) {
  auto messages = Drive(To::kRos1, {{1, 0, 0.3F}, {2, 0, 0.3F}});
  options_.scans = {"/points"};
  ExpectContains(Refusal(messages), "--cloud LOW_M,HIGH_M,REACH_M says which of them count");
  for (const char* cut : {"1,2", "2,1,10", "0,1,0", "0,1,x", "0,1,2,3"}) {
    options_.cloud = cut;
    ExpectContains(Refusal(messages), "what is meant is LOW_M,HIGH_M,REACH_M");
  }
  options_.cloud = "0,1,10";
  std::string& cloud = messages[1].bytes;
  const std::string whole = cloud;
  cloud.replace(cloud.find("\x02\0\0\0\x04\0\0\0", 0, 8), 1, "\x03");  // of points
  ExpectContains(Refusal(messages), "message 1 of /points: a cloud that is smaller than it says");
  cloud = whole;
  cloud.replace(cloud.find('z'), 1, "w");
  ExpectContains(Refusal(messages), "a cloud without x, y and z");
}

TEST_F(BagCloudTest, PointsThatBeginBeforeTheirFirstByteAreRefused) {
  auto messages = bag::SmallDrive(To::kRos1);
  const auto cloud = [](std::int32_t offset) {
    bag::Encoder out(To::kRos1);
    out.Header(1001, "base_link").Put<std::uint32_t>(1).Put<std::uint32_t>(5).Put<std::uint32_t>(3);
    for (const char* name : {"x", "y", "z"}) out.Text(name).Put(offset).Put<std::uint8_t>(7);
    return out.Put<std::uint32_t>(0).Put<std::uint32_t>(0).Put<std::uint32_t>(4).Floats({}).text();
  };
  messages.push_back({"/points", "sensor_msgs/PointCloud2", 1001, cloud(-4),
                      "std_msgs/Header header\nuint32 height\nuint32 width\nF[] fields\nuint32 "
                      "point_step\nuint32 row_step\nuint8[] data\n" +
                          std::string(80, '=') +
                          "\nMSG: sensor_msgs/F\nstring name\nint32 offset\nuint8 datatype\n"});
  Choose("0,1,10");
  ExpectContains(Refusal(messages), "message 1 of /points: no number of elements or bytes: -4");
  messages.back().bytes = cloud(0);
  ExpectContains(Refusal(messages), "5 points of 0 bytes");
}

}  // namespace
}  // namespace cairn::datasets
