#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

using bag::BagMessage;

class BagRobotsTest : public ImportBagTest {
 protected:
  // The small drive of each, in a namespace of its own; the second begins 2 s later.
  static std::vector<BagMessage> TwoDrives() {
    std::vector<BagMessage> messages;
    for (const auto& [name, later_s] : {std::pair{"/anna", 0.0}, std::pair{"/bob", 2.0}})
      for (int i = 0; i <= 10; ++i) {
        const double at = 1000 + later_s + 0.5 * i;
        messages.push_back({std::string(name) + "/odom", "nav_msgs/Odometry", at,
                            bag::OdometryMessage(To::kRos1, at, 0.1 * i, 0.01 * i)});
        messages.push_back({std::string(name) + "/scan", "sensor_msgs/LaserScan", at,
                            bag::ScanMessage(To::kRos1, at, {1, 2, 3})});
      }
    return messages;
  }
  std::vector<std::string> Robots() const { return log_.Texts("robots"); }
};

TEST_F(BagRobotsTest, NamespacesThatAllTopicsLieInAreRobots) {
  const ImportReport report = Import(TwoDrives());
  EXPECT_EQ(report.robots, 2);
  EXPECT_EQ(Robots(), (std::vector<std::string>{"anna", "bob"}));
  EXPECT_EQ(Column<double>("robot/0/laser/time_s").front(), 1000);
  EXPECT_EQ(Column<double>("robot/1/laser/time_s").front(), 1002);
  EXPECT_EQ(Column<double>("robot/1/odometry/time_s").size(),
            Column<double>("robot/0/odometry/time_s").size());
}

TEST_F(BagRobotsTest, WhoseOdometryIsNamedIsTheOnlyRobot) {
  options_.odometry = "/bob/odom";
  options_.scans = {"/bob/scan"};
  Import(TwoDrives());
  EXPECT_EQ(Robots(), (std::vector<std::string>{"robot"}));
  EXPECT_EQ(Column<double>("robot/0/laser/time_s").front(), 1002);
  options_ = {};
  options_.robots = "bob";
  Import(TwoDrives());
  EXPECT_EQ(Robots(), (std::vector<std::string>{"bob"}));
}

TEST_F(BagRobotsTest, ATopicOutsideTheNamespacesMakesItOneRobot) {
  auto messages = TwoDrives();
  messages.push_back({"/scan", "sensor_msgs/LaserScan", 1001, bag::ScanMessage(To::kRos1, 1001, {1, 2, 3})});
  ExpectContains(Refusal(messages), "--odometry TOPIC chooses one of: /anna/odom (11 of");
  options_.robots = "/bob,/anna";
  Import(messages);
  EXPECT_EQ(Robots(), (std::vector<std::string>{"bob", "anna"})) << "in the order in which they were named";
  options_.robots = "none";
  ExpectContains(Refusal(TwoDrives()), "--odometry TOPIC chooses one of: /anna/odom (11 of");
  options_.robots = "anna,carl";
  ExpectContains(Refusal(messages),
                 "--robots carl: there is no topic in that namespace; there are: 'anna', 'bob'");
  options_.robots = "anna,/anna";
  ExpectContains(Refusal(messages), "named twice");
}

TEST_F(BagRobotsTest, NamesWithoutANamespaceAreEachRobotsOwn) {
  auto messages = TwoDrives();
  for (const char* robot : {"/anna", "/bob"})
    messages.push_back({std::string(robot) + "/ekf", "nav_msgs/Odometry", 1003,
                        bag::OdometryMessage(To::kRos1, 1003, 1, 0)});
  ExpectContains(Refusal(messages), "--odometry TOPIC chooses one of: /anna/ekf (1");
  options_.odometry = "odom";
  options_.truth = "/ekf";
  options_.scans = {"/anna/scan"};  // bob's own is found by itself
  Import(messages);
  for (const char* robot : {"0", "1"}) {
    EXPECT_EQ(Column<double>("truth/robot/" + std::string(robot) + "/poses/x_m"), (std::vector<double>{1}));
    EXPECT_EQ(Column<double>("robot/" + std::string(robot) + "/laser/time_s").size(), 11U);
  }
  options_.odometry = "/odm";
  ExpectContains(Refusal(messages), "there is no such topic; the nearest: '/anna/odom'");
}

TEST_F(BagRobotsTest, AGyroThatIsNamedInFullIsOneRobots) {
  auto messages = TwoDrives();
  for (const char* robot : {"/anna", "/bob"})
    for (int i = 0; i <= 80; ++i)
      messages.push_back({std::string(robot) + "/imu", "sensor_msgs/Imu", 1000 + 0.1 * i,
                          bag::ImuMessage(To::kRos1, 1000 + 0.1 * i, 1)});
  options_.gyro = "/bob/imu*-1";
  Import(messages);
  const auto turned = [&](const std::string& robot) {
    double sum = 0;
    for (const double turn : Column<double>("robot/" + robot + "/odometry/turn_rad")) sum += turn;
    return sum;
  };
  EXPECT_NEAR(turned("0"), 0.1, 1e-9);
  EXPECT_NEAR(turned("1"), -5, 1e-6);
}

TEST_F(BagRobotsTest, FramesInTfThatAllShareAreToldApartByTheirNames) {
  std::vector<BagMessage> messages;
  for (const auto& [name, step_m] : {std::pair{"anna", 0.1}, std::pair{"bob", 0.2}}) {
    const std::string robot = name;
    for (int i = 0; i <= 10; ++i) {
      const double at = 1000 + 0.5 * i;
      messages.push_back(
          {"/tf", "tf2_msgs/TFMessage", at,
           bag::TransformMessage(To::kRos1, at, robot + "/odom", robot + "/base_link", step_m * i, 0)});
      messages.push_back({"/" + robot + "/scan", "sensor_msgs/LaserScan", at,
                          bag::ScanMessage(To::kRos1, at, {1, 2, 3}, robot + "/laser")});
    }
    messages.push_back(
        {"/tf_static", "tf2_msgs/TFMessage", 1000,
         bag::TransformMessage(To::kRos1, 0, robot + "/base_link", robot + "/laser", step_m, 0)});
  }
  options_.robots = "anna,bob";
  Import(messages);
  for (const auto& [robot, step_m] : {std::pair{"0", 0.1}, std::pair{"1", 0.2}}) {
    const std::string of = "robot/" + std::string(robot);
    EXPECT_EQ(Column<double>(of + "/laser/beam_x_m")[0], step_m);
    double way_m = 0;
    for (const double step : Column<double>(of + "/odometry/forward_m")) way_m += step;
    EXPECT_NEAR(way_m, 10 * step_m, 0.01);
  }
  options_.mounts["/scan"] = {1, 0, 0};
  options_.mounts["/bob/scan"] = {2, 0, 0};
  Import(messages);
  EXPECT_EQ(Column<double>("robot/0/laser/beam_x_m")[0], 1);
  EXPECT_EQ(Column<double>("robot/1/laser/beam_x_m")[0], 2);
}

TEST_F(BagRobotsTest, WhereNamespacesMayBeRobotsThatIsSaid) {
  auto messages = TwoDrives();
  std::erase_if(messages, [](const BagMessage& message) { return message.topic.ends_with("/scan"); });
  ExpectContains(Refusal(messages), "if these are several robots: --robots anna,bob");
  options_.robots = "anna,bob";
  EXPECT_EQ(Import(messages).robots, 2);
  options_.robots.clear();
  messages.push_back({"/anna/ekf", "nav_msgs/Odometry", 1001, messages[0].bytes});
  EXPECT_EQ(Refusal(messages).find("--robots"), std::string::npos) << "two of one robot";
}

TEST_F(BagRobotsTest, ThatAFileIsCutIsSaidBeforeThatItHasNoSuchRobot) {
  options_.robots = "anna";
  const std::string whole = bag::McapBytes(TwoDrives(), "zstd");
  ExpectContains(Refusal(whole.substr(0, 200)), "the file ends within it");
  options_.robots.clear();
  ExpectContains(Refusal(bag::McapBytes({})), "there is no topic in it");
}

}  // namespace
}  // namespace cairn::datasets
