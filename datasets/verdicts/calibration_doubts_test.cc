#include "datasets/verdicts/calibration_doubts.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/verdicts/landmark_map_verdict.h"

namespace cairn::datasets {
namespace {

// A map whose landmarks have names, and whose verdict is high.
Blob WellFitted() {
  kinds::LandmarkMap map;
  map.robots = std::vector<std::string>{"robot"};
  map.robot.resize(1);
  map.robot[0].map_landmark = std::vector<std::int32_t>(200, 0);
  map.map.landmark_identity = std::vector<std::int32_t>{0};
  map.fit.observations = 200;
  map.fit.misfits = 0;
  map.fit.longest_run = 0;
  return BlobOf(map);
}

// A robot of 1 m/s: a tenth of a second is a tenth of a metre.
TEST(CalibrationDoubts, TwoClocksThatDifferAreSaid) {
  Blob map = WellFitted();
  for (const char* name : {"time_s", "x_m"})
    map.PutVector<double>(std::string("robot/0/poses/") + name, {0, 50, 100});
  for (const char* name : {"y_m", "heading_rad"})
    map.PutVector<double>(std::string("robot/0/poses/") + name, {0, 0, 0});
  for (const double late_s : {0.8, -0.8}) {
    map.PutScalar("robot/0/observations_late_s", late_s);
    const Verdict verdict = LandmarkMapVerdict(map);
    EXPECT_EQ(verdict.trust, Confidence::kFair) << late_s;
    EXPECT_NE(verdict.why.find(late_s > 0 ? "s earlier: are" : "s later: are"), std::string::npos);
    EXPECT_NE(verdict.why.find("--sensor-late-s=" + fmt::format("{:.2g}`", late_s)), std::string::npos);
  }
  // 0.8 m along the way: by more than the path says of itself, or by less.
  for (const double sd_m : {0.05, 0.5}) {
    std::vector<double> covariance(27, 0.0);
    for (std::size_t i = 0; i < 27; i += 9) covariance[i] = covariance[i + 4] = sd_m * sd_m;
    map.PutVector("robot/0/poses/covariance", covariance);
    EXPECT_EQ(LandmarkMapVerdict(map).trust, sd_m < 0.3 ? Confidence::kLow : Confidence::kFair) << sd_m;
  }
  map.PutScalar<std::int64_t>("fit/odometry_misfits", 1);
  const std::string why = LandmarkMapVerdict(map).why;
  EXPECT_EQ(why.find("did the robot slip"), std::string::npos) << why;
  EXPECT_NE(why.find("odometry does not fit once, worst at 0.0 s: as where clocks differ"), std::string::npos)
      << why;
  map.PutScalar<std::int64_t>("fit/odometry_misfits", 0);
  map.PutScalar("robot/0/observations_late_s", 0.05);
  const Verdict little = LandmarkMapVerdict(map);
  EXPECT_EQ(little.trust, Confidence::kHigh);
  EXPECT_EQ(little.why.find("earlier"), std::string::npos) << "what is left when it was taken off";
}

// Dead reckoning that turns first, of a robot that turns while it goes, is that of a sensor half a step
// behind.
TEST(CalibrationDoubts, HalfAStepIsNotTakenForASensorThatSitsBehind) {
  Blob map = WellFitted();
  map.PutScalar("robot/0/sensor_x_m", -0.2);
  map.PutScalar("robot/0/sensor_y_m", 0.03);
  map.PutScalar("robot/0/half_step_m", 0.2);
  const std::string steps = LandmarkMapVerdict(map).why;
  EXPECT_NE(steps.find("`cairn import csv --steps-are-arcs` takes that off"), std::string::npos) << steps;
  EXPECT_EQ(steps.find("--sensor-mount"), std::string::npos) << steps;
  map.PutScalar("robot/0/sensor_x_m", -0.6);
  const std::string both = LandmarkMapVerdict(map).why;
  EXPECT_LT(both.find("--steps-are-arcs` comes first"), both.find("--sensor-mount=-0.60,0.03,0`")) << both;
  map.PutScalar("robot/0/half_step_m", 0.01);
  const std::string mount = LandmarkMapVerdict(map).why;
  EXPECT_EQ(mount.find("--steps-are-arcs"), std::string::npos) << mount;
  EXPECT_NE(mount.find("--sensor-mount="), std::string::npos) << mount;
}

// (x, y, bearings too large by, option; empty: nothing to say)
TEST(CalibrationDoubts, ASensorThatIsTurnedOrSitsElsewhereIsSaid) {
  struct Case {
    double x_m, y_m, turned_rad;
    std::string option;
  };
  for (const Case& c : {Case{0, 0, 0.02, ""},
                        {0, 0, 0.1, "=0.00,0.00,-5.7`"},
                        {0, 0, -0.1, "=0.00,0.00,5.7`"},
                        {0.05, 0.05, 0, ""},
                        {0.3, -0.1, 0, "=0.30,-0.10,"},
                        {-0.4, 0, 0.1, "=-0.40,0.00,-5.7`"}}) {
    Blob map = WellFitted();
    map.PutScalar("robot/0/bearings_turned_rad", c.turned_rad);
    map.PutScalar("robot/0/sensor_x_m", c.x_m);
    map.PutScalar("robot/0/sensor_y_m", c.y_m);
    const Verdict verdict = LandmarkMapVerdict(map);
    EXPECT_EQ(verdict.trust, c.option.empty() ? Confidence::kHigh : Confidence::kFair) << verdict.why;
    const auto at = verdict.why.find("--sensor-mount" + c.option);
    EXPECT_EQ(at != std::string::npos, !c.option.empty()) << c.option << ": " << verdict.why;
  }
}

TEST(CalibrationDoubts, OfOneRobotAmongSeveralTheOptionNamesIt) {
  Blob map = WellFitted();
  map.Put("robots", Array::Texts({"anna", "bob"}));
  map.PutVector<std::int32_t>("robot/1/observations/map_landmark", {0});
  map.PutScalar("robot/1/bearings_turned_rad", 0.2);
  const Verdict verdict = LandmarkMapVerdict(map);
  EXPECT_EQ(verdict.trust, Confidence::kFair);
  EXPECT_NE(verdict.why.find("the bearings of bob fit better"), std::string::npos) << verdict.why;
  EXPECT_NE(verdict.why.find("--sensor-mount=bob=0.00,0.00,-11`"), std::string::npos) << verdict.why;
}

// Ranges in another unit than odometry, or one of both not calibrated: everything fits, in a wrong scale.
TEST(CalibrationDoubts, OdometryOfAnotherScaleThanTheRangesIsNamed) {
  const auto scaled = [](double distances, double turns) {
    Blob map = WellFitted();
    map.PutScalar<double>("robot/0/distance_scale", distances);
    map.PutScalar<double>("robot/0/turn_scale", turns);
    return LandmarkMapVerdict(map);
  };
  EXPECT_EQ(scaled(1.05, 0.98).trust, Confidence::kHigh);
  for (const double off : {1 / 1.1, 1.1}) EXPECT_EQ(scaled(off, 1).trust, Confidence::kFair);
  for (const double off : {0.75, 1.4}) {
    EXPECT_EQ(scaled(off, 1).trust, Confidence::kLow);
    EXPECT_EQ(scaled(1, off).trust, Confidence::kFair) << "of turns the observations tell enough";
  }
  const Verdict far = scaled(1.4, 1.02);
  EXPECT_NE(far.why.find("has travelled 1.40 times as far by its ranges as by its odometry"),
            std::string::npos)
      << far.why;
  EXPECT_NE(scaled(1, 0.8).why.find("has turned 0.80 times as far"), std::string::npos);
}

// With named landmarks a factor on the ranges of one robot makes offsets of both.
TEST(CalibrationDoubts, ConstantErrorsOfRangesAreADoubtWhereThereAreSeveralRobots) {
  Blob map = WellFitted();
  map.PutScalar<double>("robot/0/range_offset_m", -0.1);
  EXPECT_EQ(LandmarkMapVerdict(map).trust, Confidence::kHigh);
  map.Put("robots", Array::Texts({"robot", "other"}));
  map.PutVector<std::int32_t>("robot/1/observations/map_landmark", {});
  EXPECT_EQ(LandmarkMapVerdict(map).trust, Confidence::kFair);
}

TEST(CalibrationDoubts, ConstantErrorsOfRangesAreSaid) {
  Blob map = WellFitted();
  map.PutScalar<double>("robot/0/range_offset_m", -0.25);
  EXPECT_EQ(
      LandmarkMapVerdict(map).Text(),
      "high: 200 observations fit the map; the ranges of robot are 0.25 m too short, which was taken off");
}

}  // namespace
}  // namespace cairn::datasets
