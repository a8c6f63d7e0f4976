#include "datasets/detect/scan_landmarks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/detect/posts.h"
#include "datasets/detect/testing_scan.h"
#include "datasets/import/recorded/recorded.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

// A robot that goes 10 m along x at half a metre a second, a scan in a fifth of a second; its laser sits 0.3
// m ahead. A post stands at (6, 2), somebody walks past at a metre a second.
class ScanLandmarksTest : public ::testing::Test {
 protected:
  static constexpr int kScans = 100;
  Blob log_;
  ScanLandmarkOptions options_;

  void SetUp() override {
    options_.poles = ScanLandmarkOptions::Widths{0.05, 0.6};
    options_.every_m = 0.05;
    std::vector<double> time_s, turn_rad(kScans), forward_m, range_m, bright, zero(361), ahead(361, 0.3),
        angle;
    for (int i = 0; i < 361; ++i) angle.push_back(HalfTurn().angle_rad(static_cast<std::size_t>(i)));
    for (int k = 0; k < kScans; ++k) {
      time_s.push_back(0.2 * k);
      forward_m.push_back(k == 0 ? 0 : 0.1);
      const ScanWorld world{{{6, 2, 0.1}, {7, 0.2 * k - 10, 0.15}}, {{-5, 5, 20, 5}, {14, -12, 14, 12}}};
      const std::vector<double> scan = world.Scan(HalfTurn(), {0.1 * k + 0.3, 0, 0});
      range_m.insert(range_m.end(), scan.begin(), scan.end());
    }
    log_.Put("robots", Array::Texts({"robot"}));
    log_.Put("landmarks", Array::Texts({}));
    log_.PutVector("robot/0/odometry/time_s", time_s);
    log_.PutVector("robot/0/odometry/turn_rad", turn_rad);
    log_.PutVector("robot/0/odometry/forward_m", forward_m);
    const std::string laser = "robot/0/laser/";
    log_.PutVector(laser + "time_s", time_s);
    log_.Put(laser + "range_m", Array::Of<double>({kScans, 361}, range_m));
    log_.PutVector(laser + "beam_x_m", ahead);
    log_.PutVector(laser + "beam_y_m", zero);
    log_.PutVector(laser + "beam_heading_rad", angle);
    log_.PutScalar(laser + "opening_rad", 0.0);
    log_.PutScalar(laser + "max_range_m", 30.0);
  }
  std::span<const double> Column(const char* name) const {
    return log_.Get<double>(std::string("robot/0/observations/") + name);
  }
};

TEST_F(ScanLandmarksTest, WhatStandsIsSeenFromTheRobotAndWhoWalksIsNot) {
  const ImportReport report = FindLandmarksInScans(options_, &log_);
  ASSERT_GT(report.observations, 40);
  ASSERT_EQ(Column("time_s").size(), static_cast<std::size_t>(report.observations));
  for (std::size_t i = 0; i < Column("time_s").size(); ++i) {
    const double x_m = 0.5 * Column("time_s")[i];
    EXPECT_NEAR(x_m + Column("range_m")[i] * std::cos(Column("bearing_rad")[i]), 6, 0.05);
    EXPECT_NEAR(Column("range_m")[i] * std::sin(Column("bearing_rad")[i]), 2, 0.05);
    EXPECT_EQ(log_.Get<std::int32_t>("robot/0/observations/landmark")[i], -1);
  }
  ASSERT_EQ(report.dropped.size(), 1u) << "the walker";
  EXPECT_GT(report.dropped.begin()->second, 10);
  EXPECT_GT(log_.Scalar<double>("noise/range_m"), 0.002);
  EXPECT_LT(log_.Scalar<double>("noise/range_m"), 0.1);
  EXPECT_LT(log_.Scalar<double>("noise/bearing_rad"), 0.01);
}

TEST_F(ScanLandmarksTest, FromWhereItStandsItSeesTheSameOnce) {
  const std::int64_t all = FindLandmarksInScans(options_, &log_).observations;
  options_.every_m = 1;
  options_.replace = true;
  const std::int64_t some = FindLandmarksInScans(options_, &log_).observations;
  EXPECT_LT(some, all / 2);
  EXPECT_GT(some, 4);
}

TEST_F(ScanLandmarksTest, WhatTwoLasersSeeAtOnceIsOneLandmark) {
  const std::int64_t one = FindLandmarksInScans(options_, &log_).observations;
  for (const char* array :
       {"time_s", "range_m", "beam_x_m", "beam_y_m", "beam_heading_rad", "opening_rad", "max_range_m"})
    log_.Put(std::string("robot/0/laser2/") + array, log_.at(std::string("robot/0/laser/") + array));
  options_.replace = true;
  EXPECT_EQ(FindLandmarksInScans(options_, &log_).observations, one);
}

TEST_F(ScanLandmarksTest, WhatItCannotDoIsRefused) {
  const auto failure = [&] { return InputErrorOf([&] { FindLandmarksInScans(options_, &log_); }); };
  options_.reflectors = ScanLandmarkOptions::Widths{0.02, 0.3};
  ExpectContains(failure(), "without intensities");
  options_.reflectors.reset();
  EXPECT_EQ(failure(), "");
  ExpectContains(failure(), "already; --replace");
  log_ = log_.Without("robot/0/laser/").Without("robot/0/observations/");
  ExpectContains(failure(), "no scans of a laser");
}

// The post bears a reflector, and the brightness of all else falls with the distance.
TEST_F(ScanLandmarksTest, ReflectorsAreTold) {
  const std::span<const double> range_m = log_.Get<double>("robot/0/laser/range_m");
  std::vector<float> bright;
  for (std::size_t i = 0; i < range_m.size(); ++i) {
    const std::size_t scan = i / 361;
    const double at = 0.1 * static_cast<double>(scan) + 0.3;
    const double angle = HalfTurn().angle_rad(i % 361), y_m = range_m[i] * std::sin(angle);
    const bool is_post = std::hypot(at + range_m[i] * std::cos(angle) - 6, y_m - 2) < 0.2;
    bright.push_back(static_cast<float>((is_post ? 200 : 20) / range_m[i]));
  }
  log_.Put("robot/0/laser/intensity", Array::Of<float>({kScans, 361}, bright));
  options_.poles.reset();
  options_.reflectors = ScanLandmarkOptions::Widths{0.05, 0.6};
  options_.least_s = 0;
  options_.least_scans = 1;
  const ImportReport report = FindLandmarksInScans(options_, &log_);
  ASSERT_GT(report.observations, 20);
  for (std::size_t i = 0; i < Column("time_s").size(); ++i)
    EXPECT_NEAR(Column("range_m")[i] * std::sin(Column("bearing_rad")[i]), 2, 0.2);
}

// The trees of Victoria Park, as J. Guivant and E. Nebot published what their own detector found in the same
// scans: of these there are 53,000, some of them people and cars.
TEST(ScanLandmarksData, WhatOthersFoundInTheSameScansIsFound) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set (docs/datasets.md)";
  RecordedImportOptions park;
  park.folder = DataFolder() + "/victoria-park";
  Blob theirs, ours;
  ImportVictoriaPark(park, &theirs);
  park.scans = true;
  EXPECT_EQ(ImportVictoriaPark(park, &ours).scans, 7230);
  ScanLandmarkOptions options;
  options.poles = ScanLandmarkOptions::Widths{0.05, 1};
  options.least_scans = 1;
  options.least_s = options.every_m = 0;
  FindLandmarksInScans(options, &ours);
  const auto column = [](const Blob& log, const char* name) {
    return log.Get<double>(std::string("robot/0/observations/") + name);
  };
  const auto their_s = column(theirs, "time_s"), our_s = column(ours, "time_s");
  const auto their_m = column(theirs, "range_m"), our_m = column(ours, "range_m");
  const auto their_rad = column(theirs, "bearing_rad"), our_rad = column(ours, "bearing_rad");
  constexpr double kSame_s = 1e-3, kSame_m = 0.3, kSame_rad = 0.035;
  std::vector<double> off_m;
  std::size_t first = 0;
  for (std::size_t i = 0; i < their_s.size(); ++i) {
    while (first < our_s.size() && our_s[first] < their_s[i] - kSame_s) ++first;
    double nearest_m = kSame_m;
    for (std::size_t k = first; k < our_s.size() && our_s[k] < their_s[i] + kSame_s; ++k) {
      const double off = our_m[k] - their_m[i];
      if (std::abs(WrapAngle(our_rad[k] - their_rad[i])) < kSame_rad && std::abs(off) < std::abs(nearest_m))
        nearest_m = off;
    }
    if (std::abs(nearest_m) < kSame_m) off_m.push_back(nearest_m);
  }
  ASSERT_GT(their_s.size(), 50000u);
  EXPECT_GT(off_m.size(), 0.94 * static_cast<double>(their_s.size()));
  EXPECT_LT(std::abs(MedianOf(off_m)), 0.01);
}

}  // namespace
}  // namespace cairn::datasets
