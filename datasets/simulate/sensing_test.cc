#include "datasets/simulate/sensing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "datasets/simulate/loop.h"

namespace cairn::datasets {
namespace {

Blob Simulate(const LoopSensing& sensing, std::uint64_t seed = 1, int robots = 1) {
  SimulateLoopOptions options{.difficulty = "base", .robots = robots, .seed = seed};
  options.sensing = sensing;
  return SimulateLoop(options);
}

struct TruePoses {
  explicit TruePoses(const Blob& log)
      : time(log.Get<double>("truth/robot/0/poses/time_s")),
        x(log.Get<double>("truth/robot/0/poses/x_m")),
        y(log.Get<double>("truth/robot/0/poses/y_m")),
        heading(log.Get<double>("truth/robot/0/poses/heading_rad")) {}
  Pose At(double time_s) const {
    const auto at = std::lower_bound(time.begin(), time.end(), time_s) - time.begin();
    const auto i = static_cast<std::size_t>(at);
    return {x[i], y[i], heading[i]};
  }
  std::span<const double> time, x, y, heading;
};

std::vector<Point> Landmarks(const Blob& log) {
  const auto x = log.Get<double>("truth/landmarks/x_m"), y = log.Get<double>("truth/landmarks/y_m");
  std::vector<Point> points;
  for (std::size_t i = 0; i < x.size(); ++i) points.push_back({x[i], y[i]});
  return points;
}

TEST(Sense, WhatIsSensedChangesNeitherDriveNorOdometry) {
  const Blob plain = Simulate({}),
             other = Simulate({.sensor = "range-bearing", .false_rate = 0.1, .types = 3});
  for (const char* part : {"robot/0/odometry/", "truth/robot/0/poses/"})
    EXPECT_EQ(plain.Sub(part).ContentHash(), other.Sub(part).ContentHash()) << part;
  const std::vector<Point> there = Landmarks(plain), here = Landmarks(other);
  ASSERT_EQ(there.size(), here.size());
  for (std::size_t i = 0; i < here.size(); ++i) EXPECT_EQ(DistanceM(there[i], here[i]), 0);
}

TEST(Sense, FalseContactsAreTheirShareAndClearOfLandmarks) {
  int all = 0, lies = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Blob log = Simulate({.false_rate = 0.2}, seed);
    const TruePoses poses(log);
    const std::vector<Point> landmarks = Landmarks(log);
    const auto truth = log.Get<std::int32_t>("truth/robot/0/observations/landmark");
    const auto time = log.Get<double>("robot/0/observations/time_s");
    EXPECT_TRUE(std::is_sorted(time.begin(), time.end()));
    for (std::size_t i = 0; i < time.size(); ++i) {
      ++all;
      if (truth[i] >= 0) continue;
      ++lies;
      const Pose at = poses.At(time[i]);
      for (const Point& landmark : landmarks)
        EXPECT_GE(DistanceM(landmark, {at.x_m, at.y_m}), kFalseContactClearanceM - 1e-6);
    }
    EXPECT_NEAR(log.Scalar<double>("noise/false_ratio"), 0.2, 0.1);
    EXPECT_NEAR(log.Scalar<double>("noise/miss_ratio"), 0.03, 0.015);
  }
  EXPECT_GT(all, 700);
  EXPECT_NEAR(lies / static_cast<double>(all), 0.2, 0.01);
}

TEST(Sense, MissedContactsAreLeftOutOfTheSameDrive) {
  int kept = 0, before = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Blob plain = Simulate({}, seed);
    const auto all = plain.Get<double>("robot/0/observations/time_s");
    const Blob log = Simulate({.miss_rate = 0.3}, seed);
    const auto some = log.Get<double>("robot/0/observations/time_s");
    EXPECT_TRUE(std::includes(all.begin(), all.end(), some.begin(), some.end()));
    kept += static_cast<int>(some.size());
    before += static_cast<int>(all.size());
    EXPECT_FALSE(log.Has("noise/false_ratio"));
    EXPECT_NEAR(log.Scalar<double>("noise/miss_ratio"), 0.3, 0.15);
  }
  EXPECT_NEAR(kept / (before / 0.97), 0.7, 0.05);
}

TEST(Sense, TypesAreMistakenAsOftenAsIsSaid) {
  int all = 0, wrong = 0;
  std::set<std::int32_t> seen;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Blob log = Simulate({.types = 3, .confusion = 0.2}, seed);
    const auto type = log.Get<std::int32_t>("robot/0/observations/type");
    const auto truth = log.Get<std::int32_t>("truth/robot/0/observations/landmark");
    const auto true_type = log.Get<std::int32_t>("truth/landmarks/type");
    EXPECT_EQ(log.Texts("types").size(), 3U);
    for (std::size_t i = 0; i < type.size(); ++i) {
      ++all;
      wrong += type[i] != true_type[static_cast<std::size_t>(truth[i])] ? 1 : 0;
      seen.insert(type[i]);
    }
    const auto confusion = log.Get<double>("noise/type_confusion");
    ASSERT_EQ(confusion.size(), 9U);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(confusion[3 * k] + confusion[3 * k + 1] + confusion[3 * k + 2], 1, 1e-12);
      EXPECT_NEAR(confusion[4 * k], 0.8, 0.1);
    }
    EXPECT_FALSE(log.Has("robot/0/sonar/time_s"));
  }
  EXPECT_GT(all, 1200);
  EXPECT_EQ(seen, (std::set<std::int32_t>{0, 1, 2}));
  EXPECT_NEAR(wrong / static_cast<double>(all), 0.2, 0.03);
}

TEST(Sense, RangesAndBearingsPointAtTheLandmark) {
  const Blob log = Simulate({.sensor = "range-bearing"});
  const TruePoses poses(log);
  const std::vector<Point> landmarks = Landmarks(log);
  const auto truth = log.Get<std::int32_t>("truth/robot/0/observations/landmark");
  const auto time = log.Get<double>("robot/0/observations/time_s"),
             range = log.Get<double>("robot/0/observations/range_m"),
             bearing = log.Get<double>("robot/0/observations/bearing_rad");
  double range_squares = 0, bearing_squares = 0;
  int far = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const Pose at = poses.At(time[i]);
    const Point to = landmarks[static_cast<std::size_t>(truth[i])];
    const double true_m = DistanceM({at.x_m, at.y_m}, to);
    range_squares += (range[i] - true_m) * (range[i] - true_m);
    EXPECT_LE(range[i], log.Scalar<double>("sensor/max_range_m"));
    EXPECT_LE(std::abs(bearing[i]), log.Scalar<double>("sensor/field_of_view_rad") / 2);
    if (true_m < 1) continue;
    const double error =
        WrapAngle(std::atan2(to.y_m - at.y_m, to.x_m - at.x_m) - at.heading_rad - bearing[i]);
    bearing_squares += error * error;
    ++far;
  }
  ASSERT_GT(far, 300);
  EXPECT_NEAR(std::sqrt(range_squares / static_cast<double>(time.size())), kCameraRangeSdM, 0.01);
  EXPECT_NEAR(std::sqrt(bearing_squares / far), kCameraBearingSdRad, 0.003);
  EXPECT_FALSE(log.Has("noise/contact_m"));
}

TEST(Sense, IdentitiesNameTheTrueLandmarkButForFalseOnes) {
  const Blob log = Simulate({.false_rate = 0.1, .identities = true});
  const auto truth = log.Get<std::int32_t>("truth/robot/0/observations/landmark");
  const auto told = log.Get<std::int32_t>("robot/0/observations/landmark");
  EXPECT_EQ(log.Texts("landmarks"), log.Texts("truth/landmarks/name"));
  int lies = 0;
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_GE(told[i], 0);
    if (truth[i] >= 0)
      EXPECT_EQ(told[i], truth[i]);
    else
      ++lies;
  }
  EXPECT_GT(lies, 3);
}

TEST(Sense, RefusesWhatMakesNoSense) {
  for (const LoopSensing& wrong : std::vector<LoopSensing>{{.sensor = "smell"},
                                                           {.false_rate = 0.6},
                                                           {.false_rate = -0.1},
                                                           {.miss_rate = 0.01},
                                                           {.types = 0},
                                                           {.types = 17},
                                                           {.types = 2, .confusion = 0.7},
                                                           {.confusion = 0.1},
                                                           {.types = 2, .identities = true}}) {
    EXPECT_THROW(Simulate(wrong), InputError);
  }
}

}  // namespace
}  // namespace cairn::datasets
