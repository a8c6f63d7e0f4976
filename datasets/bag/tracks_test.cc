#include <numbers>

#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

using bag::BagMessage;

class BagTracksTest : public ImportBagTest {
 protected:
  static std::string AllWarnings(const ImportReport& report) {
    std::string all;
    for (const std::string& warning : report.warnings) all += warning + "\n";
    return all;
  }
  static BagMessage Transform(double at_s, const std::string& parent, const std::string& child, double x,
                              double heading = 0) {
    return {"/tf", "tf2_msgs/TFMessage", at_s,
            bag::TransformMessage(To::kRos1, at_s, parent, child, x, heading)};
  }
};

TEST_F(BagTracksTest, FixesAreMetresEastAndNorthOfTheFirst) {
  auto messages = bag::SmallDrive(To::kRos1);
  // A degree of latitude is 110,574 m at the equator, one of longitude 111,320 m (WGS 84); 100 m higher up it
  // is 16 millionths more.
  const double north_deg = 1 / 110574.27, east_deg = 1 / 111319.49;
  for (int i = 0; i <= 10; ++i) {
    const double at = 1000 + 0.5 * i;
    const double north = i <= 5 ? 2.0 * i : 10, east = i <= 5 ? 0 : 2.0 * (i - 5);
    messages.push_back({"/fix", "sensor_msgs/NavSatFix", at,
                        bag::FixMessage(To::kRos1, at, north * north_deg, 7 + east * east_deg,
                                        i == 3 ? std::int8_t{-1} : std::int8_t{0}, 0.0004)});
  }
  options_.truth = "/fix";
  const ImportReport report = Import(messages);
  const auto time_s = Column<double>("truth/robot/0/poses/time_s");
  const auto x = Column<double>("truth/robot/0/poses/x_m"), y = Column<double>("truth/robot/0/poses/y_m"),
             heading = Column<double>("truth/robot/0/poses/heading_rad");
  ASSERT_EQ(time_s.size(), 10U) << "a gap stays one";
  EXPECT_EQ(time_s[3], 1002);
  EXPECT_NEAR(y[3], 8, 2e-4);
  EXPECT_NEAR(x[3], 0, 2e-4);
  EXPECT_NEAR(x.back(), 10, 2e-4);
  EXPECT_NEAR(y.back(), 10, 2e-4);
  EXPECT_NEAR(heading[1], std::numbers::pi / 2, 2e-4);
  EXPECT_NEAR(heading.back(), 0, 2e-4);
  EXPECT_EQ(report.dropped.at("messages of /fix without a fix"), 1);
  ExpectContains(AllWarnings(report),
                 "/fix: the truth is its fixes as metres east and north of 0.000000, 7.000000");
  ExpectContains(AllWarnings(report), "their covariances say 0.02 m, an axis");
  options_.truth.clear();
  options_.poses = "/fix";
  ExpectContains(Refusal(messages), "that topic is of sensor_msgs/NavSatFix");
}

class BagAntennaTest : public BagTracksTest {
 protected:
  // Ten fixes a second of an antenna at `antenna`, and `odometry` beside them.
  void Drive(const std::vector<Pose>& poses, const std::vector<Pose>& odometry, const Pose& antenna) {
    constexpr double kNorth_deg = 1 / 110574.27, kEast_deg = 1 / 111319.49;
    poses_ = poses;
    messages_.clear();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double at = 1000 + 0.1 * static_cast<double>(i);
      const Pose fix = Compose(poses[i], antenna);
      messages_.push_back({"/fix", "sensor_msgs/NavSatFix", at,
                           bag::FixMessage(To::kRos1, at, fix.y_m * kNorth_deg, 7 + fix.x_m * kEast_deg,
                                           std::int8_t{0}, 0.0004)});
      if (i < odometry.size())
        messages_.push_back({"/odom", "nav_msgs/Odometry", at,
                             bag::OdometryMessage(To::kRos1, at, odometry[i].x_m, odometry[i].heading_rad, 0,
                                                  odometry[i].y_m)});
      messages_.push_back(
          {"/scan", "sensor_msgs/LaserScan", at, bag::ScanMessage(To::kRos1, at, {1, 2.5F, 3, 30, 0.05F})});
    }
    options_.truth = "/fix";
  }
  // All of them, but for where the truth's frame begins.
  double MostOff_m() {
    const auto x = Column<double>("truth/robot/0/poses/x_m"), y = Column<double>("truth/robot/0/poses/y_m");
    EXPECT_EQ(x.size(), poses_.size());
    double most = 0;
    const double dx = x[0] - poses_[0].x_m, dy = y[0] - poses_[0].y_m;
    for (std::size_t i = 0; i < x.size(); ++i)
      most = std::max(most, std::hypot(x[i] - poses_[i].x_m - dx, y[i] - poses_[i].y_m - dy));
    return most;
  }

  std::vector<BagMessage> messages_;
  std::vector<Pose> poses_;
};

// Along an arc of 5 m to the left, by an antenna half a metre ahead of the robot's middle and to its left.
TEST_F(BagAntennaTest, FixesOfAnAntennaAsideAreThePlacesOfTheRobot) {
  std::vector<Pose> poses, odometry;
  for (int i = 0; i <= 50; ++i) {
    const double turn = 0.04 * i;
    poses.push_back(Compose({0, 0, 1}, {5 * std::sin(turn), 5 - 5 * std::cos(turn), turn}));
    odometry.push_back(Compose({3, 2, -1}, Between(poses.front(), poses.back())));
  }
  Drive(poses, odometry, {0.4, 0.3, 0});
  ExpectContains(AllWarnings(Import(messages_)), "no tf says where on the robot that is");
  EXPECT_GT(MostOff_m(), 0.2);
  options_.mounts["/fix"] = {0.4, 0.3, 0};
  ExpectContains(
      AllWarnings(Import(messages_)),
      "they are of the antenna, 0.40 m ahead of the robot's middle and 0.30 m to its left, which is "
      "taken off by odometry's headings");
  EXPECT_LT(MostOff_m(), 0.02);
  options_.mounts["/fix"] = {0.01, 0, 0};
  ExpectContains(AllWarnings(Import(messages_)), "the antenna sits in the robot's middle");
}

// Three metres on, a turn in place, three metres on, and back out of there.
TEST_F(BagAntennaTest, WhereTheRobotTurnsInPlaceOrBacksOutTheAntennaIsTakenOffRightly) {
  std::vector<Pose> poses = {{}}, odometry = {{}};
  const auto go = [&](int steps, const Pose& step) {
    for (int i = 0; i < steps; ++i) {
      poses.push_back(Compose(poses.back(), step));
      // It drifts by half a degree a metre, and its metre is 3% too long.
      const double drift = 0.009 * std::abs(step.x_m);
      odometry.push_back(Compose(odometry.back(), {1.03 * step.x_m, 0, 1.01 * step.heading_rad + drift}));
    }
  };
  go(60, {0.05, 0, 0});
  go(20, {0, 0, std::numbers::pi / 40});
  go(60, {0.05, 0, 0});
  go(60, {-0.05, 0, 0});
  go(20, {0, 0, -std::numbers::pi / 40});
  Drive(poses, odometry, {-0.8, 0.3, 0});
  options_.mounts["/fix"] = {-0.8, 0.3, 0};
  Import(messages_);
  EXPECT_LT(MostOff_m(), 0.06);
  const auto heading = Column<double>("truth/robot/0/poses/heading_rad");
  EXPECT_NEAR(heading[170], std::numbers::pi / 2, 0.05) << "it backs out";
}

TEST_F(BagAntennaTest, WhereOdometryIsMissingThereIsNoTruth) {
  std::vector<Pose> poses, odometry;
  for (int i = 0; i <= 100; ++i) {
    poses.push_back({0.05 * i, 0, 0});
    if (i <= 60) odometry.push_back(poses.back());
  }
  Drive(poses, odometry, {-0.8, 0.3, 0});
  options_.mounts["/fix"] = {-0.8, 0.3, 0};
  ExpectContains(AllWarnings(Import(messages_)), "40 of 101 are left out");
  EXPECT_EQ(Column<double>("truth/robot/0/poses/x_m").size(), 61U);
}

TEST_F(BagTracksTest, FixesFarFromTheEquatorHaveTheirOwnDegrees) {
  // At 60 degrees north: 111,412 and 55,800 m a degree.
  auto messages = bag::SmallDrive(To::kRos1);
  messages.push_back({"/fix", "sensor_msgs/NavSatFix", 1001, bag::FixMessage(To::kRos1, 1001, 60, 10)});
  messages.push_back(
      {"/fix", "sensor_msgs/NavSatFix", 1002, bag::FixMessage(To::kRos1, 1002, 60.0001, 10.0002)});
  options_.truth = "/fix";
  Import(messages);
  EXPECT_NEAR(Column<double>("truth/robot/0/poses/y_m")[1], 11.141, 0.002);
  EXPECT_NEAR(Column<double>("truth/robot/0/poses/x_m")[1], 11.160, 0.002);
}

TEST_F(BagTracksTest, TfsMapAndOdometryMakeTheTruth) {
  std::vector<BagMessage> messages = bag::SmallDrive(To::kRos1);
  for (int i = 0; i <= 10; ++i) {
    const double at = 1000 + 0.5 * i;
    messages.push_back(Transform(at, "odom", "base_footprint", 0.1 * i));
    if (i <= 6) messages.push_back(Transform(at - 0.25, "map", "odom", 0.02 * i, std::numbers::pi / 2));
  }
  messages.push_back(Transform(0, "base_footprint", "base_link", 0.5));
  options_.truth = "tf";
  options_.poses = "tf";
  const ImportReport report = Import(messages);
  for (const char* table : {"truth/robot/0/poses/", "robot/0/poses/"}) {
    const auto time_s = Column<double>(std::string(table) + "time_s");
    ASSERT_EQ(time_s.size(), 6U) << "as long as tf has a map";
    EXPECT_EQ(time_s[2], 1001);
    EXPECT_NEAR(Column<double>(std::string(table) + "x_m")[2], 0.05, 1e-9)
        << "half-way between two transforms";
    EXPECT_NEAR(Column<double>(std::string(table) + "y_m")[2], 0.2 + 0.5, 1e-9);
    EXPECT_NEAR(Column<double>(std::string(table) + "heading_rad")[2], std::numbers::pi / 2, 1e-9);
  }
  EXPECT_EQ(report.read.at("poses of map > odom > base_footprint in tf"), 6);
  EXPECT_EQ(report.dropped.at("transforms of base_footprint at a time at which tf has no map"), 10);
}

TEST_F(BagTracksTest, AFrameThatMovesOnTheMapItselfIsTheRobot) {
  std::vector<BagMessage> messages = bag::SmallDrive(To::kRos1);
  options_.truth = "tf";
  ExpectContains(Refusal(messages), "--truth tf: there is no frame in tf that lies on one called 'map'");
  for (int i = 0; i <= 10; ++i) {
    messages.push_back(Transform(1000 + 0.5 * i, "map", "a_marker", 7));
    messages.push_back(Transform(1000 + 0.5 * i, "map", "base_link", 0.2 * i));
  }
  Import(messages);
  EXPECT_EQ(Column<double>("truth/robot/0/poses/x_m")[10], 2);
  EXPECT_EQ(Column<double>("truth/robot/0/poses/x_m").size(), 11U);
}

TEST_F(BagTracksTest, OdometriesThatContradictAreTold) {
  auto messages = bag::SmallDrive(To::kRos1);
  for (int i = 0; i <= 10; ++i) {
    const double at = 1000.1 + 0.5 * i;
    messages.push_back(
        {"/wheels", "nav_msgs/Odometry", at, bag::OdometryMessage(To::kRos1, at, 0.1 * i, 0.01 * i)});
  }
  options_.odometry = "/odom";
  EXPECT_EQ(AllWarnings(Import(messages)).find("contradict"), std::string::npos)
      << "a tenth of a second aside";
  for (int i = 0; i <= 10; ++i) {
    const double at = 1000 + 0.5 * i;
    messages.push_back(
        {"/camera", "nav_msgs/Odometry", at, bag::OdometryMessage(To::kRos1, at, 0.3 * i, -0.1 * i)});
    messages.push_back(Transform(at, "odom", "base_link", 0.1 * i, 0.2 * i));
  }
  const ImportReport report = Import(messages);
  ExpectContains(
      AllWarnings(report),
      "/odom and /camera contradict each other: in the 5 s that both cover the one goes 1.0 m and turns by "
      "0.10 rad, the other 3.0 m and -1.00 rad; the log has the first");
  ExpectContains(AllWarnings(report), "/odom and odom > base_link of tf contradict each other");
  EXPECT_EQ(report.read.count("messages of /camera"), 0U);
  for (BagMessage& message : messages)
    if (message.topic == "/camera") message.bytes = "what is not taken may be bad";
  EXPECT_EQ(Import(messages).scans, 11);
}

TEST_F(BagTracksTest, TurnsToBothSidesAreHeldAgainstEachOther) {
  // To the left for two seconds, to the right for two.
  const auto heading = [](double since_s) { return 0.4 * std::abs(std::remainder(since_s, 4)); };
  std::vector<BagMessage> messages;
  const auto add = [&](const std::string& topic, double late_s, double factor) {
    for (int i = 0; i <= 80; ++i) {
      const double at = 1000 + late_s + 0.25 * i;
      messages.push_back({topic, "nav_msgs/Odometry", at,
                          bag::OdometryMessage(To::kRos1, at, 0.1 * i, factor * heading(0.25 * i))});
    }
  };
  options_.odometry = "/odom";
  add("/odom", 0, 1);
  add("/late", 0.1, 1);
  EXPECT_EQ(AllWarnings(Import(messages)).find("contradict"), std::string::npos);
  add("/wide", 0, 0.5);
  ExpectContains(AllWarnings(Import(messages)),
                 "/odom and /wide contradict each other: in the 20 s that both cover the one goes 8.0 m and "
                 "turns by 8.00 rad to the left and the right together, the other 8.0 m and 4.00 rad");
}

}  // namespace
}  // namespace cairn::datasets
