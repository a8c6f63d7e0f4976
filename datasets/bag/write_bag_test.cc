#include "datasets/bag/write_bag.h"

#include <numbers>

#include "datasets/bag/inspect_bag.h"
#include "datasets/bag/testing_import.h"

namespace cairn::datasets {
namespace {

class WriteBagTest : public ImportBagTest {
 protected:
  // A robot that goes, turns and goes, with two sonars, and what it saw on its way.
  static Blob SmallLog(int robots) {
    Blob log;
    std::vector<std::string> names;
    for (int robot = 0; robot < robots; ++robot) {
      const std::string of = "robot/" + std::to_string(robot) + "/";
      names.push_back("robot " + std::to_string(robot));
      log.PutVector(of + "odometry/time_s", std::vector<double>{0, 1, 2, 2, 3});
      log.PutVector(of + "odometry/turn_rad", std::vector<double>{0, 0, 0.2, 0.2, 0.5});
      log.PutVector(of + "odometry/forward_m", std::vector<double>{0, 0.5, 0.4, 0, 0.3});
      log.PutVector(of + "observations/time_s", std::vector<double>{1, 1, 2});
      log.PutVector(of + "observations/landmark", std::vector<std::int32_t>{-1, 1, -1});
      log.PutVector(of + "observations/range_m", std::vector<double>{2, 3, std::nan("")});
      log.PutVector(of + "observations/bearing_rad", std::vector<double>{0.5, -0.5, std::nan("")});
      log.PutVector(of + "sonar/time_s", std::vector<double>{1, 2});
      log.Put(of + "sonar/range_m", Array::Of<double>({2, 2}, std::vector<double>{1, 2, std::nan(""), 4}));
      log.PutVector(of + "sonar/beam_x_m", std::vector<double>{0.1, 0});
      log.PutVector(of + "sonar/beam_y_m", std::vector<double>{0, 0.2});
      log.PutVector(of + "sonar/beam_heading_rad", std::vector<double>{0, std::numbers::pi / 2});
      log.PutScalar<double>(of + "sonar/opening_rad", 0.25);
      log.PutScalar<double>(of + "sonar/max_range_m", 5);
      log.PutVector("truth/" + of + "poses/time_s", std::vector<double>{0, 3});
      log.PutVector("truth/" + of + "poses/x_m", std::vector<double>{7, 8});
      log.PutVector("truth/" + of + "poses/y_m", std::vector<double>{1, 1});
      log.PutVector("truth/" + of + "poses/heading_rad", std::vector<double>{0.5, 1});
    }
    log.Put("robots", Array::Texts(names));
    log.Put("landmarks", Array::Texts({"a", "b"}));
    return log;
  }
  static Pose EndOf(const std::vector<double>& turn_rad, const std::vector<double>& forward_m) {
    Pose at;
    for (std::size_t i = 0; i < turn_rad.size(); ++i)
      at = Compose(Compose(at, {0, 0, turn_rad[i]}), {forward_m[i], 0, 0});
    return at;
  }
  void ExpectSmallLog(const std::string& robot) {
    const Pose end = EndOf(Column<double>("robot/" + robot + "/odometry/turn_rad"),
                           Column<double>("robot/" + robot + "/odometry/forward_m"));
    const Pose made = EndOf({0, 0, 0.2, 0.2, 0.5}, {0, 0.5, 0.4, 0, 0.3});
    EXPECT_NEAR(end.x_m, made.x_m, 0.006);
    EXPECT_NEAR(end.y_m, made.y_m, 0.006);
    EXPECT_NEAR(end.heading_rad, made.heading_rad, 1e-9);
    const std::string sonar = "robot/" + robot + "/sonar/";
    EXPECT_EQ(Column<double>(sonar + "time_s"), (std::vector<double>{1e9 + 1, 1e9 + 2}));
    const auto range = Column<double>(sonar + "range_m");
    ASSERT_EQ(range.size(), 4U);
    EXPECT_EQ(range[1], 2);
    EXPECT_TRUE(std::isnan(range[2]));
    EXPECT_EQ(Column<double>(sonar + "beam_y_m"), (std::vector<double>{0, 0.2}));
    EXPECT_NEAR(Column<double>(sonar + "beam_heading_rad")[1], std::numbers::pi / 2, 1e-9);
    EXPECT_NEAR(log_.Scalar<double>(sonar + "opening_rad"), 0.25, 1e-9);
    const std::string seen = "robot/" + robot + "/observations/";
    ASSERT_EQ(Column<double>(seen + "time_s"), (std::vector<double>{1e9 + 1, 1e9 + 1, 1e9 + 2}));
    EXPECT_NEAR(Column<double>(seen + "range_m")[1], 3, 1e-12);
    EXPECT_NEAR(Column<double>(seen + "bearing_rad")[1], -0.5, 1e-12);
    EXPECT_EQ(Column<std::int32_t>(seen + "landmark"), (std::vector<std::int32_t>{-1, 0, -1}));
    EXPECT_EQ(log_.Texts("landmarks"), (std::vector<std::string>{"1"}));
    EXPECT_TRUE(std::isnan(Column<double>(seen + "range_m")[2])) << "a contact";
    EXPECT_EQ(Column<double>("truth/robot/" + robot + "/poses/x_m"), (std::vector<double>{7, 8}));
    EXPECT_NEAR(Column<double>("truth/robot/" + robot + "/poses/heading_rad")[0], 0.5, 1e-12);
  }
};

TEST_F(WriteBagTest, ALogComesBackFromItsBag) {
  options_.landmarks = {"/landmarks:x=poses.position.x,y=poses.position.y", "/contacts:contact", "/markers"};
  options_.truth = "/truth";
  const std::string bytes = BagOfLog(SmallLog(1));
  Import(bytes);
  ExpectSmallLog("0");
  options_.wheels = "left_wheel_joint,right_wheel_joint,0.1,0.4";
  const ImportReport report = Import(bytes);
  ExpectSmallLog("0");
  for (const std::string& warning : report.warnings)
    EXPECT_TRUE(warning.find("contradict") == std::string::npos &&
                warning.find("covariances") == std::string::npos)
        << warning;
  const BagInspection bag = InspectBag(folder_.Put("drive.bag", bytes));
  EXPECT_TRUE(bag.remarks.empty()) << bag.remarks.front();
  EXPECT_EQ(bag.topics.size(), 9U);
}

TEST_F(WriteBagTest, PosesOfTheSameTimesAsOdometryLeaveTimesAsTheyAre) {
  Blob log = SmallLog(1).Without("robot/0/sonar/");
  log.PutVector("truth/robot/0/poses/time_s", std::vector<double>{0, 1, 2, 3});
  for (const char* column : {"x_m", "y_m", "heading_rad"})
    log.PutVector("truth/robot/0/poses/" + std::string(column), std::vector<double>{0, 1, 2, 3});
  options_.truth = "/truth";
  options_.landmarks = {"/landmarks:x=poses.position.x,y=poses.position.y"};
  Import(BagOfLog(log));
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{1e9 + 1}));
}

TEST_F(WriteBagTest, RobotsLieInNamespaces) {
  options_.landmarks = {"landmarks:x=poses.position.x,y=poses.position.y", "contacts:contact,time=stamp",
                        "markers"};
  options_.truth = "truth";
  Import(BagOfLog(SmallLog(2)));
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"robot0", "robot1"}));
  ExpectSmallLog("0");
  ExpectSmallLog("1");
}

TEST_F(WriteBagTest, ALongLogHasSeveralChunks) {
  Blob log = SmallLog(1);
  const std::size_t rows = 10'000;
  std::vector<double> time_s, zero(rows, 0), forward_m(rows, 0.01);
  for (std::size_t i = 0; i < rows; ++i) time_s.push_back(0.01 * static_cast<double>(i));
  log.PutVector("robot/0/odometry/time_s", time_s);
  log.PutVector("robot/0/odometry/turn_rad", zero);
  log.PutVector("robot/0/odometry/forward_m", forward_m);
  const std::string bytes = BagOfLog(log);
  EXPECT_GT(bytes.size(), 3'000'000U);
  const ImportReport report = Import(bytes);
  EXPECT_EQ(report.read.at("messages of /odom"), static_cast<std::int64_t>(rows));
  double way_m = 0;
  for (const double step : Column<double>("robot/0/odometry/forward_m")) way_m += step;
  EXPECT_NEAR(way_m, 0.01 * static_cast<double>(rows - 1), 0.01);
}

}  // namespace
}  // namespace cairn::datasets
