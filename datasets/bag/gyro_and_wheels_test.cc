#include <numbers>
#include <numeric>

#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

using bag::BagMessage;

class GyroAndWheelsTest : public ImportBagTest {
 protected:
  static constexpr double kBias = 0.012;

  // Stands for 3 s, goes 5 m in 10 s while it turns by `turn_rad` and the odometry says nothing of it, stands
  // again.
  static std::vector<BagMessage> BlindTurn(double turn_rad, double sign = 1, double per_rad = 1) {
    std::vector<BagMessage> messages;
    for (int i = 0; i <= 160; ++i) {
      const double at = 1000 + 0.1 * i;
      const double way = std::clamp(0.05 * (i - 30), 0.0, 5.0);
      messages.push_back({"/odom", "nav_msgs/Odometry", at, bag::OdometryMessage(To::kRos1, at, way, 0)});
      messages.push_back({"/scan", "sensor_msgs/LaserScan", at, bag::ScanMessage(To::kRos1, at, {1, 2})});
    }
    for (int i = 0; i <= 3200; ++i) {
      const double at = 999.9975 + 0.005 * i;
      const double rate = at >= 1003 && at <= 1013 ? turn_rad / 10 : 0;
      messages.push_back({"/imu", "sensor_msgs/Imu", at,
                          bag::ImuMessage(To::kRos1, at, sign * per_rad * (rate + kBias), "imu_link")});
    }
    return messages;
  }
  double Turn() const {
    const auto turn = Column<double>("robot/0/odometry/turn_rad");
    return std::accumulate(turn.begin(), turn.end(), 0.0);
  }
  double Way() const {
    const auto way = Column<double>("robot/0/odometry/forward_m");
    return std::accumulate(way.begin(), way.end(), 0.0);
  }
  static void ExpectWarning(const ImportReport& report, const std::string& part) {
    std::string all;
    for (const std::string& warning : report.warnings) all += warning + "\n";
    ExpectContains(all, part);
  }
};

TEST_F(GyroAndWheelsTest, TheGyroTurnsTheOdometryAndItsBiasIsMeasuredInHalts) {
  const double turn = std::numbers::pi / 2;
  auto messages = BlindTurn(turn);
  Import(messages);
  EXPECT_NEAR(Turn(), 0, 1e-9);
  options_.gyro = "/imu";
  const ImportReport report = Import(messages);
  EXPECT_NEAR(Turn(), turn, 0.003);
  EXPECT_NEAR(Way(), 5, 0.02);
  ExpectWarning(report, "/imu: the odometry turns as this gyro does; its bias, measured in 2 halts of 5.6 s");
  ExpectWarning(report, "0.01200 to 0.01200 rad/s");
  ExpectWarning(report, "no tf says how 'imu_link' lies on the robot");
}

TEST_F(GyroAndWheelsTest, AGyroIsTurnedAsItIsMounted) {
  auto messages = BlindTurn(1, -1);
  messages.push_back({"/tf_static", "tf2_msgs/TFMessage", 1000,
                      bag::TransformMessage(To::kRos1, 0, "base_link", "imu_link", 0.1, 2, true)});
  options_.gyro = "/imu";
  Import(messages);
  EXPECT_NEAR(Turn(), 1, 0.003) << "upside down";
  options_.gyro = "/imu*deg";
  messages = BlindTurn(1, 1, 180 / std::numbers::pi);
  Import(messages);
  EXPECT_NEAR(Turn(), 1, 0.003);
}

TEST_F(GyroAndWheelsTest, InAGapOfTheGyroTheOdometryTurnsByItself) {
  auto messages = BlindTurn(1);
  std::erase_if(messages, [](const BagMessage& message) {
    return message.topic == "/imu" && message.receive_s > 1006 && message.receive_s < 1008;
  });
  options_.gyro = "/imu";
  const ImportReport report = Import(messages);
  EXPECT_NEAR(Turn(), 0.78, 0.001) << "two seconds, and the steps about them";
  ExpectWarning(report, "steps of the odometry lie in gaps of the gyro");
}

TEST_F(GyroAndWheelsTest, OdometryAndAGyroThatContradictAreTold) {
  std::vector<BagMessage> messages;
  for (int i = 0; i <= 200; ++i) {
    const double at = 1000 + 0.1 * i;
    messages.push_back({"/odom", "nav_msgs/Odometry", at, bag::OdometryMessage(To::kRos1, at, 0, 0.02 * i)});
    messages.push_back({"/scan", "sensor_msgs/LaserScan", at, bag::ScanMessage(To::kRos1, at, {1, 2})});
    messages.push_back({"/imu", "sensor_msgs/Imu", at, bag::ImuMessage(To::kRos1, at, -0.2)});
  }
  options_.gyro = "/imu";
  ImportReport report = Import(messages);
  ExpectWarning(report,
                "by a radian the gyro turns by -1.00: one of the two is wrong; does it hang upside down");
  ExpectWarning(report, "never stands still for a second");
  options_.gyro = "/imu*-1";
  report = Import(messages);
  for (const std::string& warning : report.warnings)
    EXPECT_EQ(warning.find("is wrong"), std::string::npos) << warning;
  options_.gyro = "/imu*-57.3";
  ExpectWarning(Import(messages), "are its rates in degrees? --gyro /imu*deg");
  options_.gyro = "/scan";
  ExpectContains(Refusal(messages), "that topic is of sensor_msgs/LaserScan; what serves: /imu");
}

TEST_F(GyroAndWheelsTest, WheelsOfStatedSizeAreOdometry) {
  // Straight on for a turn of each wheel, then about the middle, of positions that stay within a turn.
  const double radius = 0.05, distance = 0.4;
  for (const bool are_within_a_turn : {false, true}) {
    std::vector<BagMessage> messages;
    for (int i = 0; i <= 40; ++i) {
      const double at = 1000 + 0.1 * i;
      double left = i <= 20 ? 0.1 * std::numbers::pi * i : 2 * std::numbers::pi - 0.1 * (i - 20);
      double right = i <= 20 ? left : 2 * std::numbers::pi + 0.1 * (i - 20);
      if (are_within_a_turn) left = WrapAngle(left), right = WrapAngle(right);
      messages.push_back({"/joints", "sensor_msgs/JointState", at,
                          bag::JointMessage(To::kRos1, at, {"arm", "r", "l"}, {7, right, left})});
      messages.push_back(
          {"/joints", "sensor_msgs/JointState", at, bag::JointMessage(To::kRos1, at, {"lid"}, {0.5 * i})});
      messages.push_back({"/scan", "sensor_msgs/LaserScan", at, bag::ScanMessage(To::kRos1, at, {1, 2})});
    }
    options_.wheels = "l,r,0.05,0.4";
    Import(messages);
    EXPECT_NEAR(Way(), 2 * std::numbers::pi * radius, 1e-9);
    EXPECT_NEAR(Turn(), 2 * radius * 2 / distance, 1e-9);
    options_.wheels = "l,wheel,0.05,0.4";
    ExpectContains(Refusal(messages), "no message of /joints has both wheels; it has the joints 'arm', 'r'");
  }
}

TEST_F(GyroAndWheelsTest, WheelsWithoutPositionsGoByTheirVelocities) {
  std::vector<BagMessage> messages;
  for (int i = 0; i <= 20; ++i) {
    const double at = 1000 + 0.1 * i;
    messages.push_back(
        {"/joints", "sensor_msgs/JointState", at, bag::JointMessage(To::kCdr, at, {"l", "r"}, {}, {2, 4})});
    messages.push_back({"/scan", "sensor_msgs/LaserScan", at, bag::ScanMessage(To::kCdr, at, {1, 2})});
  }
  options_.wheels = "l,r,0.1,0.5";
  const auto import = [&] { return Import(bag::McapBytes(messages), "drive.mcap"); };
  import();
  EXPECT_NEAR(Way(), 2 * 0.3, 1e-6);
  EXPECT_NEAR(Turn(), 2 * 0.4, 1e-6);
  messages[6].bytes = bag::JointMessage(To::kCdr, 1000.3, {"l", "r"}, {100, 200});
  import();
  EXPECT_NEAR(Way(), (2 - 0.2) * 0.3, 1e-6) << "of a position among velocities nothing follows";
  messages[6].bytes = bag::JointMessage(To::kCdr, 1000.3, {"l", "r"}, {}, {1});
  ExpectContains(InputErrorOf(import), "message 4 of /joints: wheels without a position or a velocity");
}

TEST_F(GyroAndWheelsTest, WheelsThatAreNoneAreRefused) {
  const auto messages = bag::SmallDrive(To::kRos1);
  for (const char* wheels : {"l,r", "l,r,0,1", "l,l,0.1,1", "l,r,0.1,x", ",r,0.1,1", "l,r,0.1,0.2,3"}) {
    options_.wheels = wheels;
    ExpectContains(Refusal(messages), "what is meant is LEFT_JOINT,RIGHT_JOINT,RADIUS_M,DISTANCE_M");
  }
  options_.wheels = "l,r,0.1,0.5";
  ExpectContains(Refusal(messages), "there is no topic of sensor_msgs/JointState");
}

}  // namespace
}  // namespace cairn::datasets
