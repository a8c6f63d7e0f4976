// Logs in which some observations name their landmark and some do not: those may be of a landmark that others
// name.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"
#include "schema/geometry.h"
#include "schema/kinds/landmark_map.h"
#include "schema/rng.h"

namespace cairn::landmark_map {
namespace {

constexpr const char* kNameOf = "robot/0/observations/landmark";

BlobPtr PartlyNamedMap(const Blob& log) {
  return RunInProcess(LandmarkMap(Options{}), {{"log", std::make_shared<const Blob>(log)}});
}

// Without the names of so many of a hundred observations, and of all of `nameless`.
Blob WithoutNames(Blob log, int of_hundred, std::int32_t nameless = -1) {
  Rng rng(5);
  std::vector<std::int32_t> named;
  for (const std::int32_t k : log.Get<std::int32_t>(kNameOf))
    named.push_back(k == nameless || 100.0 * rng.Uniform() < of_hundred ? -1 : k);
  log.PutVector(kNameOf, named);
  return log;
}

std::multiset<std::int32_t> NamesIn(const Blob& result) {
  const auto identity = result.Get<std::int32_t>("map/landmark_identity");
  return {identity.begin(), identity.end()};
}

TEST(PartlyNamed, ALandmarkThatIsNamedNowAndThenIsThereOnce) {
  const Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = true}.Make();
  for (const int of_hundred : {50, 95}) {
    const BlobPtr result = PartlyNamedMap(WithoutNames(log, of_hundred));
    EXPECT_EQ(NamesIn(*result), (std::multiset<std::int32_t>{0, 1, 2, 3, 4, 5})) << of_hundred;
    const auto named = log.Get<std::int32_t>(kNameOf);
    const auto found = result->Get<std::int32_t>("robot/0/observations/map_landmark");
    std::size_t right = 0;
    for (std::size_t i = 0; i < named.size(); ++i) right += named[i] == found[i] ? 1 : 0;
    EXPECT_GT(right, named.size() * 98 / 100) << of_hundred;
  }
}

TEST(PartlyNamed, ALandmarkThatNobodyNamesStays) {
  const Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = true}.Make();
  EXPECT_EQ(NamesIn(*PartlyNamedMap(WithoutNames(log, 50, 5))),
            (std::multiset<std::int32_t>{-1, 0, 1, 2, 3, 4}));
}

TEST(PartlyNamed, AButtonThatIsNamedNowAndThenIsThereOnce) {
  const Blob log = SquareLog{.laps = 6, .side_m = 20.0, .identified = true}.Make();
  EXPECT_EQ(NamesIn(*PartlyNamedMap(WithoutNames(log, 50))), (std::multiset<std::int32_t>{0, 1, 2, 3}));
}

// One of the robots reads names, the first or the other.
TEST(PartlyNamed, ARobotWithoutNamesIsPlacedByWhereLandmarksStand) {
  const Blob named = PostsLog{.drift_rad_per_m = 0.002, .named = true}.Make();
  const Blob nameless =
      WithoutNames(PostsLog{.drift_rad_per_m = 0.002, .seed = 2, .named = true}.Make(), 100);
  for (const bool first : {true, false}) {
    Blob log = first ? named : nameless;
    log.Put("robots", Array::Texts({"one", "two"}));
    log.PutAll("robot/1/", (first ? nameless : named).Sub("robot/0/"));
    const BlobPtr result = PartlyNamedMap(log);
    EXPECT_EQ(NamesIn(*result), (std::multiset<std::int32_t>{0, 1, 2, 3, 4, 5})) << first;
    EXPECT_EQ(result->Scalar<std::int64_t>("robot/1/shared_landmarks"), 6) << first;
    EXPECT_GT(result->Scalar<double>("robot/1/place_lead_nats"), 10.0) << first;
  }
}

// Posts strewn over a hall of 40 m by 16 m; every fifth bears a name.
std::vector<Point> PostsInAHall() {
  Rng rng(3);
  std::vector<Point> posts;
  for (int p = 0; p < 40; ++p) {
    const double x_m = 40 * rng.Uniform();
    posts.push_back({x_m, 16 * rng.Uniform()});
  }
  return posts;
}
std::int32_t NameOf(std::size_t post) { return post % 5 == 0 ? static_cast<std::int32_t>(post / 5) : -1; }

// Under robot/0/: who goes from point to point and sees the posts ahead within 6 m.
Blob DriveThroughTheHall(const std::vector<Point>& way, std::uint64_t seed) {
  constexpr double kStep_m = 0.4, kSees_m = 6;
  Rng rng(seed);
  std::vector<double> time, turn, forward, seen_s, range, bearing;
  std::vector<std::int32_t> landmark;
  Point at = way[0];
  double heading = std::atan2(way[1].y_m - at.y_m, way[1].x_m - at.x_m);
  const std::vector<Point> posts = PostsInAHall();
  for (std::size_t k = 1; k < way.size(); ++k) {
    while (DistanceM(at, way[k]) > kStep_m) {
      const double to = std::atan2(way[k].y_m - at.y_m, way[k].x_m - at.x_m);
      const double turned = std::clamp(std::remainder(to - heading, 2 * std::numbers::pi), -0.4, 0.4);
      heading += turned;
      at = {at.x_m + kStep_m * std::cos(heading), at.y_m + kStep_m * std::sin(heading)};
      time.push_back(0.4 * static_cast<double>(time.size() + 1));
      turn.push_back(turned + 0.001 + 0.003 * rng.Normal());
      forward.push_back(kStep_m + 0.005 * rng.Normal());
      for (std::size_t p = 0; p < posts.size(); ++p) {
        const double ahead = std::remainder(
            std::atan2(posts[p].y_m - at.y_m, posts[p].x_m - at.x_m) - heading, 2 * std::numbers::pi);
        if (time.size() % 2 != 0 || DistanceM(at, posts[p]) > kSees_m || std::abs(ahead) > 1.5) continue;
        seen_s.push_back(time.back());
        landmark.push_back(NameOf(p));
        range.push_back(DistanceM(at, posts[p]) + 0.05 * rng.Normal());
        bearing.push_back(ahead + 0.01 * rng.Normal());
      }
    }
  }
  Blob log;
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  log.PutVector("robot/0/observations/landmark", landmark);
  log.PutVector("robot/0/observations/time_s", seen_s);
  log.PutVector("robot/0/observations/range_m", range);
  log.PutVector("robot/0/observations/bearing_rad", bearing);
  return log;
}

// The named posts of the map stand to one another as in the hall; how many there are.
std::size_t NamedPostsInPlace(const Blob& result) {
  const auto map = Read<kinds::LandmarkMap>(result).map;
  const std::vector<Point> posts = PostsInAHall();
  std::size_t named = 0;
  for (std::size_t a = 0; a < map.landmark_identity.size(); ++a) {
    if (map.landmark_identity[a] < 0) continue;
    ++named;
    for (std::size_t b = 0; b < a; ++b) {
      if (map.landmark_identity[b] < 0) continue;
      const auto truth = [&](std::size_t l) {
        return posts[static_cast<std::size_t>(5 * map.landmark_identity[l])];
      };
      EXPECT_NEAR(
          std::hypot(map.landmark_x_m[a] - map.landmark_x_m[b], map.landmark_y_m[a] - map.landmark_y_m[b]),
          DistanceM(truth(a), truth(b)), 0.3)
          << map.landmark_identity[a] << " and " << map.landmark_identity[b];
    }
  }
  return named;
}

// What the second robot sees first is no part of the first one's map, and has no name.
TEST(PartlyNamed, ARobotThatComesFromBeyondTheFirstOnesMapIsPlacedByNames) {
  Blob log = DriveThroughTheHall({{2, 2}, {18, 2}, {18, 14}, {2, 14}, {2, 2}, {18, 2}, {18, 14}}, 1);
  log.PutAll(
      "robot/1/",
      DriveThroughTheHall({{38, 2}, {38, 14}, {16, 14}, {16, 2}, {38, 2}, {38, 14}}, 2).Sub("robot/0/"));
  log.Put("robots", Array::Texts({"one", "two"}));
  log.Put("landmarks", Array::Texts({"a", "b", "c", "d", "e", "f", "g", "h"}));
  std::set<std::int32_t> names;
  for (const char* row : {kNameOf, "robot/1/observations/landmark"})
    for (const std::int32_t name : log.Get<std::int32_t>(row))
      if (name >= 0) names.insert(name);
  const BlobPtr result =
      RunInProcess(LandmarkMap({.starts = 2, .waves = 0}), {{"log", std::make_shared<const Blob>(log)}});
  EXPECT_GE(names.size(), 6U);
  EXPECT_EQ(NamedPostsInPlace(*result), names.size());
}

}  // namespace
}  // namespace cairn::landmark_map
