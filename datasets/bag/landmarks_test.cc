#include <numbers>

#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

using bag::BagMessage;
using bag::Encoder;

class BagLandmarksTest : public ImportBagTest {
 protected:
  struct Target {
    double distance_m, angle_deg;
    std::string label;
  };
  static BagMessage Reflectors(double at_s, const std::vector<Target>& targets, To to = To::kRos1,
                               const std::string& frame = "base_link") {
    Encoder out(to);
    out.Header(at_s, frame).Put(static_cast<std::uint32_t>(targets.size()));
    for (const Target& target : targets)
      out.Put(1e3 * target.distance_m).Put(target.angle_deg).Text(target.label);
    return {"/reflectors", "acme_msgs/Reflectors", at_s, out.text(),
            "std_msgs/Header header\nTarget[] targets\n" + std::string(80, '=') +
                "\nMSG: acme_msgs/Target\nfloat64 mm\nfloat64 angle\nstring label\n"};
  }
  static BagMessage Detections(double at_s, const std::vector<int>& ids) {
    return {"/detections", "apriltag_msgs/AprilTagDetectionArray", at_s,
            bag::TagsMessage(To::kCdr, at_s, ids)};
  }
  static BagMessage TagFrame(double at_s, const std::string& tag, double x_m,
                             const std::string& topic = "/tf") {
    return {topic, "tf2_msgs/TFMessage", at_s,
            bag::TransformMessage(To::kCdr, at_s, "camera", tag, x_m, 0.3)};
  }
};

TEST_F(BagLandmarksTest, AnyMessagesFieldsAreLandmarksWhereTheyAreNamed) {
  options_.landmarks = {"/reflectors:range=targets.mm*0.001,bearing=targets.angle*deg,id=targets.label"};
  for (const To to : {To::kRos1, To::kCdr}) {
    auto messages = bag::SmallDrive(to);
    messages.push_back(Reflectors(1001, {{2, 90, "north"}, {3, -45, "?"}}, to));
    messages.push_back(Reflectors(1002, {}, to));
    messages.push_back(Reflectors(1003, {{1, 180, "north"}}, to));
    to == To::kRos1 ? Import(messages) : Import(bag::McapBytes(messages), "drive.mcap");
    const std::string at = "robot/0/observations/";
    EXPECT_EQ(Column<double>(at + "time_s"), (std::vector<double>{1001, 1001, 1003}));
    EXPECT_EQ(Column<std::int32_t>(at + "landmark"), (std::vector<std::int32_t>{0, -1, 0}));
    EXPECT_NEAR(Column<double>(at + "range_m")[1], 3, 1e-12);
    EXPECT_NEAR(Column<double>(at + "bearing_rad")[0], std::numbers::pi / 2, 1e-12);
    EXPECT_NEAR(Column<double>(at + "bearing_rad")[1], -std::numbers::pi / 4, 1e-12);
  }
}

TEST_F(BagLandmarksTest, PointsAreOfTheSensorsFrame) {
  // As cameras have it: x to the right, z ahead.
  auto messages = bag::SmallDrive(To::kRos1);
  messages.push_back(Reflectors(1001, {{0.5, 2, ""}}, To::kRos1, "camera"));
  Encoder mount(To::kRos1);
  mount.Put<std::uint32_t>(1)
      .Header(0, "base_link")
      .Text("camera")
      .Doubles({0.2, 0, 0.5, -0.5, 0.5, -0.5, 0.5});
  messages.push_back({"/tf_static", "tf2_msgs/TFMessage", 1000, mount.text()});
  options_.landmarks = {"/reflectors:x=targets.mm*0.001,z=targets.angle"};
  Import(messages);
  EXPECT_NEAR(Column<double>("robot/0/observations/range_m")[0], std::hypot(2.2, 0.5), 1e-9);
  EXPECT_NEAR(Column<double>("robot/0/observations/bearing_rad")[0], std::atan2(-0.5, 2.2), 1e-9);
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark")[0], -1);
}

TEST_F(BagLandmarksTest, AFieldThatIsNotThereIsNamedWithTheNearest) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages.push_back(Reflectors(1001, {{2, 90, "a"}}));
  options_.skip_bad = true;  // what somebody named is not skipped
  options_.landmarks = {"/reflectors:range=targets.m,bearing=targets.angle"};
  ExpectContains(Refusal(messages),
                 "acme_msgs/Reflectors has no field 'targets.m'; the nearest: 'targets.mm'");
  options_.landmarks = {"/reflectors"};
  const std::string refusal = Refusal(messages);
  ExpectContains(refusal, "of acme_msgs/Reflectors, whose fields are to be named");
  ExpectContains(refusal, "'header.frame_id', 'targets.mm', 'targets.angle', 'targets.label'");
  for (const auto& [given, why] :
       {std::pair{"/reflectors:range=targets.mm", "a range and a bearing are needed"},
        std::pair{"/reflectors:range=a,bearing=b,x=c,y=d", "a range and a bearing are needed"},
        std::pair{"/reflectors:x=a", "two of x, y and z"},
        std::pair{"/reflectors:x=a,y=a", "'a' is named twice"},
        std::pair{"/reflectors:x=a,size=b", "'size=b' is no KEY=FIELD"},
        std::pair{"/reflectors:x=a,y=", "'y=' names no field"},
        std::pair{"/reflectors:x=a*0,y=b", "'0' is nothing to multiply by"},
        std::pair{"/reflectors:contact,x=a,y=b", "a contact is at the landmark itself"},
        std::pair{"tf:", "as tf:tag36h11"}}) {
    options_.landmarks = {given};
    ExpectContains(Refusal(messages), why);
  }
}

TEST_F(BagLandmarksTest, AContactIsAtTheRobotItself) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages.push_back(Reflectors(1001, {{2, 90, "a"}, {3, 0, "unknown"}}));
  options_.landmarks = {"/reflectors:contact,id=targets.label"};
  Import(messages);
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{0, -1}));
  EXPECT_TRUE(std::isnan(Column<double>("robot/0/observations/range_m")[0]));
  options_.landmarks = {"/reflectors:contact"};
  Import(messages);
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{-1}))
      << "of each message one";
}

TEST_F(BagLandmarksTest, FieldsOfOtherNumbersAreABadMessage) {
  auto messages = bag::SmallDrive(To::kRos1);
  messages.push_back(Reflectors(1001, {{2, 90, "a"}, {3, 0, "b"}}));
  options_.landmarks = {"/reflectors:range=targets.mm,bearing=header.stamp"};
  ExpectContains(
      Refusal(messages),
      "message 1 of /reflectors: other numbers of one field than of another: 2 of 'targets.mm', 1 of");
  messages.back() = Reflectors(1001, {{-2, 90, "a"}});
  options_.landmarks = {"/reflectors:range=targets.mm,bearing=targets.angle"};
  ExpectContains(Refusal(messages), "no range of a landmark");
}

TEST_F(BagLandmarksTest, TagsOfRos2AreWhereTheirFramesAreInTf) {
  auto messages = bag::SmallDrive(To::kCdr);
  messages.push_back({"/tf_static", "tf2_msgs/TFMessage", 1000,
                      bag::TransformMessage(To::kCdr, 0, "base_link", "camera", 0.5, 0)});
  messages.push_back(TagFrame(1001, "tag36h11:7", 2));
  messages.push_back(Detections(1001, {7, 8}));
  messages.push_back(Detections(1002, {8}));
  messages.push_back(TagFrame(1002, "tag36h11:8", 3));
  messages.push_back(TagFrame(1002.5, "tag36h11:8", 9));  // of no detection
  options_.landmarks = {"/detections"};
  const auto import = [&] { return Import(bag::McapBytes(messages), "drive.mcap"); };
  const ImportReport report = import();
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{1001, 1002}));
  EXPECT_NEAR(Column<double>("robot/0/observations/range_m")[0], 2.5, 1e-9);
  EXPECT_NEAR(Column<double>("robot/0/observations/range_m")[1], 3.5, 1e-9);
  EXPECT_EQ(report.dropped.at("detections of tags without the place of their frame in tf"), 1);
  std::erase_if(messages, [](const BagMessage& message) { return message.topic == "/tf"; });
  ExpectContains(InputErrorOf(import), "apriltag_ros says it in /tf, as the place of 'tag36h11:7'");
}

TEST_F(BagLandmarksTest, FramesOfTfAreLandmarksByTheBeginningOfTheirNames) {
  auto messages = bag::SmallDrive(To::kCdr);
  messages.push_back(TagFrame(1000, "dock_map", 5, "/tf_static"));  // holds at all times: nobody saw it
  messages.push_back(TagFrame(1001, "dock_1", 2));
  messages.push_back(TagFrame(1003, "dock_2", 3));
  messages.push_back(TagFrame(1003, "arm", 1));
  options_.landmarks = {"tf:dock_"};
  options_.mounts["camera"] = {0, 0, std::numbers::pi / 2};
  Import(bag::McapBytes(messages), "drive.mcap");
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{1001, 1003}));
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{0, 1}));
  EXPECT_NEAR(Column<double>("robot/0/observations/bearing_rad")[1], std::numbers::pi / 2, 1e-9);
}

TEST_F(BagLandmarksTest, TagsWithoutANumberEachAreABadMessage) {
  auto messages = bag::SmallDrive(To::kRos1);
  Encoder out(To::kRos1);
  out.Header(1001, "camera").Put<std::uint32_t>(1).Put<std::uint32_t>(2).Text("a").Text("b");
  out.Put<std::uint32_t>(0);
  messages.push_back({"/tags", "apriltag_msgs/AprilTagDetectionArray", 1001, out.text(),
                      "std_msgs/Header header\nT[] detections\n" + std::string(80, '=') +
                          "\nMSG: apriltag_msgs/T\nstring[] family\nint32[] id\n"});
  options_.landmarks = {"/tags"};
  ExpectContains(
      Refusal(messages),
      "message 1 of /tags: other numbers of one field than of another: 2 of 'detections.family', 0 "
      "of 'detections.id'");
}

TEST_F(BagLandmarksTest, TwoFieldsOfOneNameAreNoNames) {
  auto messages = bag::SmallDrive(To::kRos1);
  for (const char* second : {"int32 label", "uint8[1] label"}) {
    Encoder out(To::kRos1);
    out.Header(1001, "base_link").Text("a");
    std::string(second).starts_with("int32") ? out.Put<std::int32_t>(7) : out.Put<std::uint8_t>(7);
    messages.push_back({"/bumper", "acme_msgs/Bumper", 1001, out.text(),
                        "std_msgs/Header header\nstring label\n" + std::string(second) + "\n"});
    options_.landmarks = {"/bumper:contact,id=label"};
    ExpectContains(Refusal(messages), "message 1 of /bumper: markers without a number or a name each");
    messages.pop_back();
  }
}

}  // namespace
}  // namespace cairn::datasets
