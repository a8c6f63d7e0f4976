#include "datasets/bag/tag_images.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

using bag::BagMessage;
using bag::Encoder;

// Images of 4 by 3 pixels with a stand-in for cairn-tags, which says of each that it shows tag 7, of 0.2 m,
// two metres ahead and half a metre to the right of a camera of its own making.
class TagImagesTest : public ImportBagTest {
 protected:
  Camera camera_{400, 410, 320, 240, {-0.1, 0.01, 0, 0, 0, 0, 0, 0}};
  std::vector<BagMessage> messages_ = bag::SmallDrive(To::kCdr);
  std::string images_;  // that the detector was given
  std::string second_ = "640 480 0";
  std::string size_ = "640 480";            // of the first
  std::array<std::uint32_t, 6> part_ = {};  // binning in x and y; the ROI's x, y, height, width

  void SetUp() override {
    options_.tags = {"/camera/image_raw=0.2"};
    options_.mounts["/camera/image_raw"] = {0.1, 0, 0};
    options_.find_tags = [this](const std::string& family, const std::string& images) {
      EXPECT_EQ(family, "tag36h11");
      images_ += images;
      std::ostringstream line;
      line << size_ << " 1 7";
      for (const auto& [x, y] : {std::pair(-0.1, 0.1), {0.1, 0.1}, {0.1, -0.1}, {-0.1, -0.1}}) {
        const Eigen::Vector2d px = camera_.Project({0.5 + x, y, 2});
        line << ' ' << px.x() << ' ' << px.y();
      }
      return line.str() + "\n" + second_ + "\n";
    };
    messages_.push_back(Info());
    for (const double at_s : {1001.0, 1002.0}) messages_.push_back(ImageOf(at_s, "rgb8", 3));
  }
  static BagMessage ImageOf(double at_s, const std::string& encoding, unsigned pixel_bytes,
                            bool is_big_endian = false) {
    const unsigned step = 4 * pixel_bytes + 1;  // a byte more than its pixels
    Encoder out(To::kCdr);
    out.Header(at_s, "camera").Put<std::uint32_t>(3).Put<std::uint32_t>(4).Text(encoding);
    out.Put<std::uint8_t>(is_big_endian ? 1 : 0).Put<std::uint32_t>(step).Put<std::uint32_t>(3 * step);
    for (unsigned i = 0; i < 3 * step; ++i) out.Put(static_cast<std::uint8_t>(i));
    return {"/camera/image_raw", "sensor_msgs/Image", at_s, out.text()};
  }
  BagMessage Info() const {
    Encoder out(To::kCdr);
    out.Header(1000, "camera").Put<std::uint32_t>(480).Put<std::uint32_t>(640).Text("plumb_bob");
    out.Put<std::uint32_t>(5).Doubles({camera_.distortion[0], camera_.distortion[1], 0, 0, 0});
    out.Doubles({camera_.fx, 0, camera_.cx, 0, camera_.fy, camera_.cy, 0, 0, 1});
    for (int i = 0; i < 9 + 12; ++i) out.Put(0.0);
    for (const std::uint32_t number : part_) out.Put(number);
    out.Put<std::uint8_t>(0);
    return {"/camera/camera_info", "sensor_msgs/CameraInfo", 1000, out.text()};
  }
  ImportReport ImportMcap() { return Import(bag::McapBytes(messages_), "drive.mcap"); }
  void ExpectTag(double ahead_m, double left_m) {
    ASSERT_EQ(Column<double>("robot/0/observations/range_m").size(), 1u);
    EXPECT_NEAR(Column<double>("robot/0/observations/range_m")[0], std::hypot(ahead_m, left_m), 1e-3);
    EXPECT_NEAR(Column<double>("robot/0/observations/bearing_rad")[0], std::atan2(left_m, ahead_m), 1e-3);
    EXPECT_EQ(log_.Texts("landmarks"), (std::vector<std::string>{"tag36h11:7"}));
  }
};

TEST_F(TagImagesTest, TagsAreLandmarksWhereTheCameraSitsAndLooks) {
  const ImportReport report = ImportMcap();
  EXPECT_EQ(report.read.at("tags in 2 images of /camera/image_raw"), 1);
  ExpectTag(2.1, -0.5);
  EXPECT_EQ(Column<double>("robot/0/observations/time_s")[0], 1001);
  EXPECT_GT(log_.Scalar<double>("noise/range_m"), log_.Scalar<double>("noise/bearing_rad"));
  // Grey, the mean of three colours, row by row: a file each.
  const std::string grey = std::string("P5 4 3 255\n") + "\1\4\7\12\16\21\24\27\33\36\41\44";
  EXPECT_EQ(images_, std::to_string(grey.size()) + "\n" + grey + std::to_string(grey.size()) + "\n" + grey);

  options_.mounts["/camera/image_raw"] = {0, 0.2, std::numbers::pi / 2};
  ImportMcap();
  ExpectTag(0.5, 2.2);
}

TEST_F(TagImagesTest, OfGreyOfTwoBytesTheHigherOneCounts) {
  std::erase_if(messages_, [](const BagMessage& one) { return one.topic == "/camera/image_raw"; });
  for (const bool is_big_endian : {false, true})
    messages_.push_back(ImageOf(is_big_endian ? 1002 : 1001, "mono16", 2, is_big_endian));
  ImportMcap();
  std::string low("P5 4 3 255\n"), high = low;  // rows of eight bytes, and one that is no pixel's
  for (const char row : {0, 9, 18})
    for (const char at : {0, 2, 4, 6}) {
      low += static_cast<char>(row + at + 1);
      high += static_cast<char>(row + at);
    }
  const std::string bytes = std::to_string(low.size()) + "\n";
  EXPECT_EQ(images_, bytes + low + bytes + high);
}

// An optical frame looks along its z axis; one whose z axis points up is the camera's body.
TEST_F(TagImagesTest, TfSaysWhereTheCameraIs) {
  options_.mounts.clear();
  messages_.push_back({"/tf_static", "tf2_msgs/TFMessage", 1000,
                       bag::TransformMessage(To::kCdr, 1000, "base_link", "camera", 0.3, std::numbers::pi)});
  ImportMcap();
  ExpectTag(0.3 - 2, 0.5);
}

// As image_geometry has it: camera_info is of the whole sensor, of which the image shows a part, or every
// second column and third row.
TEST_F(TagImagesTest, APartOfTheSensorIsThatPart) {
  const auto with_part = [&](const std::array<std::uint32_t, 6>& part) {
    part_ = part;
    std::erase_if(messages_, [](const BagMessage& one) { return one.topic == "/camera/camera_info"; });
    messages_.push_back(Info());
  };
  with_part({2, 3, 40, 60, 240, 300});
  camera_ = {200, 410.0 / 3, 140, 60, camera_.distortion};
  size_ = "150 80";
  second_ = "150 80 0";
  ImportMcap();
  ExpectTag(2.1, -0.5);
  second_ = "640 480 1 8 0 0 10 0 10 10 0 10";
  EXPECT_EQ(ImportMcap().dropped.at("image of /camera/image_raw of another size than the first"), 1);
  // Images that somebody made smaller, and did not say so.
  second_ = "320 240 0";
  size_ = "320 240";
  ExpectContains(
      Refusal(bag::McapBytes(messages_)),
      "/camera/image_raw: its images are of 320 by 240 pixels, its camera_info is of 150 by 80 pixels: "
      "--camera");
}

TEST_F(TagImagesTest, WhatCannotBeUsedIsSaidOrCounted) {
  second_ = "!it cannot be decoded";
  EXPECT_EQ(ImportMcap().dropped.at("image of /camera/image_raw that cannot be decoded"), 1);
  second_ = "640 480 1 8 0 0 10 0 500 10 7 300";
  EXPECT_EQ(ImportMcap().dropped.at("tag whose corners fit no square of its size"), 1);
  const auto refusal = [&] { return Refusal(bag::McapBytes(messages_)); };
  second_ = "640 480 1 8 0 0";
  ExpectContains(refusal(), "does not say a tag's corners");
  messages_.push_back(ImageOf(1003, "float32", 4));
  ExpectContains(refusal(), "an image of an encoding that is not known: float32");
  messages_.back() = ImageOf(1003, "rgba8", 4);
  messages_.back().bytes.resize(messages_.back().bytes.size() - 1);
  ExpectContains(refusal(), "a message that does not match its definition");
  messages_.pop_back();
  std::erase_if(messages_, [](const BagMessage& one) { return one.topic == "/camera/camera_info"; });
  second_ = "640 480 0";
  ExpectContains(refusal(), "no camera_info beside it says what its camera is like: --camera");
  const double fx = camera_.fx;
  camera_.fx = std::numeric_limits<double>::infinity();
  messages_.push_back(Info());
  ExpectContains(refusal(), "no camera: its numbers are not finite; --camera");
  messages_.pop_back();
  camera_.fx = fx;
  options_.camera = "400,410,320,240,-0.1,0.01,0,0";
  EXPECT_EQ(refusal(), "");
  ExpectTag(2.1, -0.5);
}

TEST(ParseTagSource, AndParseCamera) {
  EXPECT_EQ(bag::ParseTagSource("/a=b/image=0.16").topic, "/a=b/image");
  for (const char* wrong : {"", "=0.1", "/image", "/image=", "/image=0", "/image=-1", "/image=x"})
    ExpectContains(InputErrorOf([&] { bag::ParseTagSource(wrong); }), "what is meant is TOPIC=METRES");
  EXPECT_EQ(bag::ParseCamera("1,2,3,4,5,6,7,8,9").distortion[4], 9);
  for (const char* wrong : {"1,2,3", "0,1,2,3", "1,2,3,x", "1,2,3,4,5,6,7,8,9,10,11,12,13"})
    ExpectContains(InputErrorOf([&] { bag::ParseCamera(wrong); }), "what is meant is FX,FY,CX,CY");
}

}  // namespace
}  // namespace cairn::datasets
