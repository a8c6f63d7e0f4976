#include "pipelines/landmark_map/refinement/sensor_shift.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "schema/geometry.h"
#include "schema/rng.h"

namespace cairn::landmark_map {
namespace {

// A robot of 1 m/s whose sensor's clock is `late_s` late, through the pipeline.
BlobPtr MapOfLate(const PostsLog& posts, double late_s) {
  Blob log = posts.Make();
  const auto time = log.Get<double>("robot/0/observations/time_s");
  std::vector<double> late(time.begin(), time.end());
  for (double& time_s : late) time_s += late_s;
  log.PutVector("robot/0/observations/time_s", late);
  return RunInProcess(LandmarkMap({}), {{"log", std::make_shared<const Blob>(log)}});
}

TEST(FindSensorShifts, FindByHowMuchAndWhichIsLate) {
  for (const bool named : {true, false}) {
    for (const double late_s : {0.8, 0.4, -0.4, -0.9}) {
      const BlobPtr map = MapOfLate({.drift_rad_per_m = 0.002, .named = named}, late_s);
      ASSERT_TRUE(map->Has("robot/0/observations_late_s")) << named << ", " << late_s;
      EXPECT_NEAR(map->Scalar<double>("robot/0/observations_late_s"), late_s, 0.1) << named;
    }
  }
}

// Rows of what one robot saw.
struct SeenPosts {
  std::vector<std::int32_t> landmark;
  std::vector<double> time_s, range_m, bearing_rad;
};

// A log of fourteen landmarks that all have names.
Blob NamedLog(const std::vector<double>& time_s, const std::vector<double>& turn_rad,
              const std::vector<double>& forward_m, const SeenPosts& seen) {
  Blob log = PostsLog{.named = true}.Make();
  log.Put("landmarks", Array::Texts({"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m", "n"}));
  log.PutVector("robot/0/odometry/time_s", time_s);
  log.PutVector("robot/0/odometry/turn_rad", turn_rad);
  log.PutVector("robot/0/odometry/forward_m", forward_m);
  log.PutVector("robot/0/observations/landmark", seen.landmark);
  log.PutVector("robot/0/observations/time_s", seen.time_s);
  log.PutVector("robot/0/observations/range_m", seen.range_m);
  log.PutVector("robot/0/observations/bearing_rad", seen.bearing_rad);
  return log;
}

// A robot of 1 m/s in bends to either side, whose odometry is of poses: of each time a row that turns and
// goes, and one that turns on.
struct EvenDrive {
  std::vector<double> time_s;
  std::vector<Pose> at;
  Blob log;

  explicit EvenDrive(double late_s, std::uint64_t seed = 1) {
    constexpr double kRow_s = 0.2, kReach_m = 8.0;
    Rng rng(seed);
    std::vector<Point> posts;
    for (int p = 0; p < 14; ++p) posts.push_back({rng.Uniform(-10, 14), rng.Uniform(-8, 14)});
    std::vector<double> row_s, turn, forward, seen_s, range, bearing;
    std::vector<std::int32_t> landmark;
    Pose pose;
    for (int k = 1; k <= 700; ++k) {
      const double turned = 0.1 * std::sin(0.06 * k) + 0.04;
      pose = Compose(Compose(pose, {0, 0, 0.5 * turned}), {kRow_s, 0, 0});
      pose.heading_rad += 0.5 * turned;
      time_s.push_back(kRow_s * k);
      at.push_back(pose);
      const double said = turned + 0.002 * rng.Normal();
      row_s.insert(row_s.end(), 2, time_s.back());
      turn.insert(turn.end(), 2, 0.5 * said);
      forward.insert(forward.end(), {kRow_s + 0.002 * rng.Normal(), 0.0});
      for (int p = 0; p < 14 && k % 5 == 0; ++p) {
        const Pose seen = Between(
            pose, {posts[static_cast<std::size_t>(p)].x_m, posts[static_cast<std::size_t>(p)].y_m, 0});
        if (seen.x_m <= 0 || std::hypot(seen.x_m, seen.y_m) > kReach_m) continue;
        seen_s.push_back(time_s.back() + late_s);
        landmark.push_back(p);
        range.push_back(std::hypot(seen.x_m, seen.y_m) + 0.05 * rng.Normal());
        bearing.push_back(std::atan2(seen.y_m, seen.x_m) + 0.02 * rng.Normal());
      }
    }
    log = NamedLog(row_s, turn, forward, {landmark, seen_s, range, bearing});
  }

  // What the map's path is off from the true one, at most, the one laid on the other.
  double FurthestOff_m(const Blob& map) const {
    const auto time = map.Get<double>("robot/0/poses/time_s"), x = map.Get<double>("robot/0/poses/x_m"),
               y = map.Get<double>("robot/0/poses/y_m");
    std::vector<Eigen::Vector2d> mapped, right;
    for (std::size_t i = 0, k = 0; i < time.size(); ++i) {
      while (k < time_s.size() && time_s[k] < time[i] - 1e-6) ++k;
      if (k == time_s.size() || time_s[k] > time[i] + 1e-6) continue;
      mapped.emplace_back(x[i], y[i]);
      right.emplace_back(at[k].x_m, at[k].y_m);
    }
    const auto columns = [](const std::vector<Eigen::Vector2d>& points) {
      return Eigen::Map<const Eigen::Matrix2Xd>(points.front().data(), 2, std::ssize(points));
    };
    const Eigen::Matrix3d onto = Eigen::umeyama(columns(mapped), columns(right), false);
    const Eigen::Matrix2Xd off =
        ((onto.topLeftCorner<2, 2>() * columns(mapped)).colwise() + onto.topRightCorner<2, 1>()) -
        columns(right);
    return off.colwise().norm().maxCoeff();
  }
};

// Its speed tells nothing, its bends do; and what was found, taken off, makes the map right.
TEST(FindSensorShifts, FindALateClockAtConstantSpeed) {
  for (const double late_s : {0.3, -0.3, 0.4, -0.5, 0.0}) {
    const EvenDrive drive(late_s);
    const BlobPtr map = RunInProcess(LandmarkMap({}), {{"log", std::make_shared<const Blob>(drive.log)}});
    ASSERT_EQ(map->Has("robot/0/observations_late_s"), late_s != 0.0) << late_s;
    EXPECT_FALSE(map->Has("robot/0/sensor_x_m")) << late_s;
    if (late_s == 0.0) continue;
    const double found_s = map->Scalar<double>("robot/0/observations_late_s");
    EXPECT_NEAR(found_s, late_s, 0.04);
    const BlobPtr mended = RunInProcess(
        LandmarkMap({}), {{"log", std::make_shared<const Blob>(EvenDrive(late_s - found_s).log)}});
    EXPECT_FALSE(mended->Has("robot/0/observations_late_s")) << late_s;
    EXPECT_LT(drive.FurthestOff_m(*mended), 0.13) << late_s;
    EXPECT_GT(drive.FurthestOff_m(*map), 0.15) << late_s;
  }
}

TEST(FindSensorShifts, FindByHowMuchASensorIsTurned) {
  for (const bool named : {true, false}) {
    for (const double turned_rad : {0.1, -0.05}) {
      Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = named}.Make();
      const auto before = log.Get<double>("robot/0/observations/bearing_rad");
      std::vector<double> bearing(before.begin(), before.end());
      for (double& rad : bearing) rad += turned_rad;
      log.PutVector("robot/0/observations/bearing_rad", bearing);
      const BlobPtr map = RunInProcess(LandmarkMap({}), {{"log", std::make_shared<const Blob>(log)}});
      ASSERT_TRUE(map->Has("robot/0/bearings_turned_rad")) << named << ", " << turned_rad;
      EXPECT_NEAR(map->Scalar<double>("robot/0/bearings_turned_rad"), turned_rad, 0.01) << named;
      EXPECT_FALSE(map->Has("robot/0/observations_late_s"));
    }
  }
}

// Half a metre ahead, or behind, to the side, and turned besides.
TEST(FindSensorShifts, FindWhereASensorSits) {
  for (const bool named : {true, false}) {
    for (const Pose& mount : {Pose{0.5, 0, 0}, Pose{-0.4, 0.1, 0}, Pose{0.3, 0, 0.14}}) {
      Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = named}.Make();
      const auto range = log.Get<double>("robot/0/observations/range_m"),
                 bearing = log.Get<double>("robot/0/observations/bearing_rad");
      std::vector<double> seen_range, seen_bearing;
      for (std::size_t i = 0; i < range.size(); ++i) {
        const Pose at = Between(mount, {range[i] * std::cos(bearing[i]), range[i] * std::sin(bearing[i]), 0});
        seen_range.push_back(std::hypot(at.x_m, at.y_m));
        seen_bearing.push_back(std::atan2(at.y_m, at.x_m));
      }
      log.PutVector("robot/0/observations/range_m", seen_range);
      log.PutVector("robot/0/observations/bearing_rad", seen_bearing);
      const BlobPtr map = RunInProcess(LandmarkMap({}), {{"log", std::make_shared<const Blob>(log)}});
      ASSERT_TRUE(map->Has("robot/0/sensor_x_m")) << named << ", " << mount.x_m;
      EXPECT_NEAR(map->Scalar<double>("robot/0/sensor_x_m"), mount.x_m, 0.1) << named;
      EXPECT_NEAR(map->Scalar<double>("robot/0/sensor_y_m"), mount.y_m, 0.1) << named;
      EXPECT_NEAR(map->Scalar<double>("robot/0/bearings_turned_rad"), -mount.heading_rad, 0.03) << named;
      EXPECT_FALSE(map->Has("robot/0/observations_late_s"));
    }
  }
}

// There and back on one line, backwards: it sees the same from wherever on it the sensor sits.
TEST(FindSensorShifts, NoneOfARobotThatNeverTurns) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    constexpr int kLegs = 4, kSteps = 100;
    constexpr double kStep_m = 0.2;
    Rng rng(seed);
    std::vector<Point> posts;
    for (int p = 0; p < 14; ++p) posts.push_back({rng.Uniform(-2, 22), rng.Uniform(-4, 4)});
    std::vector<double> time, turn, forward, seen_s, range, bearing;
    std::vector<std::int32_t> landmark;
    double x = 0, y = 0, heading = 0;
    for (int k = 0; k < kLegs * kSteps; ++k) {
      const double way = (k / kSteps % 2 == 0 ? 1 : -1) * kStep_m, turned = 0.004 * rng.Normal();
      heading += turned;
      x += way * std::cos(heading);
      y += way * std::sin(heading);
      time.push_back(0.4 * (k + 1));
      turn.push_back(turned + 0.004 * rng.Normal());
      forward.push_back(way * (1 + 0.02 * rng.Normal()));
      for (int p = 0; p < 14 && k % 3 == 0; ++p) {
        const double dx = posts[static_cast<std::size_t>(p)].x_m - x,
                     dy = posts[static_cast<std::size_t>(p)].y_m - y;
        const double ahead = std::remainder(std::atan2(dy, dx) - heading, 2.0 * std::numbers::pi);
        if (std::hypot(dx, dy) > 5.0 || std::abs(ahead) > 1.25) continue;
        seen_s.push_back(time.back());
        landmark.push_back(p);
        range.push_back(std::hypot(dx, dy) + 0.1 * rng.Normal());
        bearing.push_back(ahead + 0.03 * rng.Normal());
      }
    }
    const Blob log = NamedLog(time, turn, forward, {landmark, seen_s, range, bearing});
    const BlobPtr map = RunInProcess(LandmarkMap({}), {{"log", std::make_shared<const Blob>(log)}});
    EXPECT_FALSE(map->Has("robot/0/sensor_x_m")) << seed;
  }
}

TEST(FindSensorShifts, NoneWhereClocksAgreeAndBearingsAreRight) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    for (const bool named : {true, false}) {
      const BlobPtr map = MapOfLate({.drift_rad_per_m = 0.01, .seed = seed, .named = named}, 0.0);
      EXPECT_FALSE(map->Has("robot/0/observations_late_s")) << seed << ", " << named;
      EXPECT_FALSE(map->Has("robot/0/bearings_turned_rad")) << seed << ", " << named;
      EXPECT_FALSE(map->Has("robot/0/sensor_x_m")) << seed << ", " << named;
    }
  }
}

}  // namespace
}  // namespace cairn::landmark_map
