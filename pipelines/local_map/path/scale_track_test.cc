#include "pipelines/local_map/path/scale_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pipelines/local_map/testing/room.h"
#include "schema/rng.h"

namespace cairn::local_map {
namespace {

struct Driven {
  std::vector<Scan> scans;  // by odometry
  std::vector<Approach> approaches;
  std::vector<WayFit> ways;
  std::vector<double> x_m;  // true
};

// To and fro in a room, so many times, which stands at 0.3 rad to the way; odometry says `measured` of a
// metre at each step.
Driven ToAndFro(int drives, const std::function<double(int)>& measured, int every = 1) {
  const std::vector<TestWall> walls = TestBox(8, 5, {0, 0, 0.3});
  Rng rng(3);
  Driven run;
  ScaleWatch watch({{LaserBeams(), 0, 10}}, ScaleWatch::Towards::kAhead);
  WayWatch ways({{LaserBeams(), 0, 10}});
  double by_odometry = 0, travelled = 0;
  for (int drive = 0; drive < drives; ++drive) {
    const double sign = drive % 2 == 0 ? 1 : -1;
    for (int s = 0; s < 40; ++s) {
      const auto scan = static_cast<std::int64_t>(run.scans.size());
      const double x = sign * (-1.6 + 0.08 * s), step = 0.08 * measured(static_cast<int>(scan));
      by_odometry += sign * step;
      travelled += step;
      const double heading = drive % 2 == 0 ? 0 : M_PI;
      const std::vector<double> ranges = LaserScan(walls, {x, 0, heading}, rng);
      const RingScan read{0.2 * static_cast<double>(scan), 0, ranges};
      run.scans.push_back({.time_s = read.time_s, .pose = {by_odometry, 0, heading}, .path_m = travelled});
      run.x_m.push_back(x);
      if (s % every == 0) watch.Update(scan, run.scans.back().pose, {&read, 1});
      ways.Update(scan, run.scans.back().pose, {&read, 1});
    }
  }
  watch.Finish();
  run.approaches = watch.approaches();
  run.ways = ways.found();
  EXPECT_GE(run.approaches.size(), static_cast<std::size_t>(drives));
  return run;
}

TEST(ScaleTrack, OfOdometryThatIsRightThereIsNone) {
  for (const double measured : {0.97, 1.0, 1.03}) {
    const Driven run = ToAndFro(20, [&](int) { return measured; });
    EXPECT_TRUE(TrackScale(run.approaches, run.scans).empty()) << measured;
  }
  EXPECT_TRUE(TrackScale({}, {}).empty());
}

// A person who comes towards the robot at a third of its speed makes its metre 1.33 to whatever looks ahead
// alone.
TEST(ScaleTrack, IsBorneOutByWhatStandsBesideTheWayOrNot) {
  for (const double measured : {0.7, 1.3}) {
    const Driven run = ToAndFro(20, [&](int) { return measured; });
    const std::vector<MetreAt> track = TrackScale(run.approaches, run.scans);
    ASSERT_FALSE(track.empty());
    EXPECT_TRUE(IsBorneOut(track, run.ways, run.scans)) << measured;
    EXPECT_FALSE(IsBorneOut(track, {run.ways.begin(), run.ways.begin() + 9}, run.scans)) << "too few";
  }
  const Driven right = ToAndFro(20, [](int) { return 1.0; });
  for (const double scale : {0.75, 1.33, 2.0})
    EXPECT_FALSE(IsBorneOut({{.scale = scale}}, right.ways, right.scans)) << scale;
}

TEST(ScaleTrack, WholeScansFitBestWhereTheRobotWas) {
  const Driven run = ToAndFro(4, [](int) { return 0.8; });
  ASSERT_GE(run.ways.size(), 4U);
  for (const WayFit& fit : run.ways) {
    const auto best = std::ranges::max_element(fit.share);
    EXPECT_GT(*best, 0.9);
    EXPECT_NEAR(fit.share[NearestWayScale(1 / 0.8)], *best, 0.05);
    EXPECT_LT(fit.share[NearestWayScale(1)], 0.9 * *best);
  }
}

TEST(ScaleTrack, FindsAMetreThatIsFarOff) {
  for (const double measured : {0.4, 0.7, 1.3, 1 / 0.3048}) {
    Driven run = ToAndFro(20, [&](int) { return measured; });
    const std::vector<MetreAt> track = TrackScale(run.approaches, run.scans);
    ASSERT_EQ(track.size(), run.approaches.size());
    for (const MetreAt& metre : track) EXPECT_NEAR(metre.scale * measured, 1, 0.01);
    Rescale(track, &run.scans);
    EXPECT_NEAR((run.scans.back().path_m - run.scans.front().path_m) / (0.08 * 799), 1, 0.01) << measured;
  }
}

// A third of what is ahead is something else that comes into view, or a person who walks.
TEST(ScaleTrack, ManyOtherThingsDoNotMisleadIt) {
  Driven run = ToAndFro(20, [](int) { return 0.8; });
  Rng rng(5);
  for (std::size_t i = 0; i < run.approaches.size(); i += 3)
    run.approaches[i].along_distance_m2 *= rng.Uniform(0.3, 1.8);
  const std::vector<MetreAt> track = TrackScale(run.approaches, run.scans);
  ASSERT_EQ(track.size(), run.approaches.size());
  for (const MetreAt& metre : track) EXPECT_NEAR(metre.scale, 1.25, 0.02);
}

// Persons who walk before it tell of any scale.
TEST(ScaleTrack, WhereNothingAgreesThereIsNone) {
  Driven run = ToAndFro(20, [](int) { return 1.0; });
  Rng rng(5);
  for (Approach& approach : run.approaches) approach.along_distance_m2 *= rng.Uniform(0.3, 3);
  EXPECT_TRUE(TrackScale(run.approaches, run.scans).empty());
}

// A scan every 0.8 m.
TEST(ScaleTrack, ALaserMayBeReadSeldom) {
  const Driven run = ToAndFro(40, [](int) { return 0.7; }, 10);
  const std::vector<MetreAt> track = TrackScale(run.approaches, run.scans);
  ASSERT_EQ(track.size(), run.approaches.size());
  for (const MetreAt& metre : track) EXPECT_NEAR(metre.scale * 0.7, 1, 0.02);
}

TEST(ScaleTrack, FollowsAScaleThatDrifts) {
  const auto measured = [](int s) { return std::exp(0.2 * std::sin(0.004 * s)); };
  Driven run = ToAndFro(40, measured);
  const std::vector<MetreAt> track = TrackScale(run.approaches, run.scans);
  ASSERT_EQ(track.size(), run.approaches.size());
  for (const MetreAt& metre : track) {
    const int scan = static_cast<int>(std::lround(metre.time_s / 0.2));
    EXPECT_NEAR(metre.scale * measured(scan), 1, 0.04) << scan;
  }
  const double off_m = std::abs(run.scans.back().pose.x_m - run.x_m.back());
  Rescale(track, &run.scans);
  EXPECT_LT(
      std::abs(run.scans.back().pose.x_m - run.scans.front().pose.x_m - (run.x_m.back() - run.x_m.front())),
      std::max(0.1, off_m / 5));
}

}  // namespace
}  // namespace cairn::local_map
