#include "pipelines/landmark_map/refinement/one_sided.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

// A robot drives along six posts, 3 m beside its way of 20 m, once and then once more, and sees those within
// 6 m, all round.
struct TwoPasses {
  std::vector<double> x_m = {2, 5, 8, 11, 14, 17};
  // Of the second pass: how many of its 21 nodes there are, how far on it is, and which landmark it takes a
  // post for.
  int nodes = 21;
  double on_m = 0;
  std::function<int(int)> taken_for = [](int post) { return post; };
  std::function<bool(int, int)> sees = [](int, int) { return true; };  // at that node, that post

  OneSided Find() const {
    LeastSquaresProblem problem;
    LeastSquaresPoint point;
    problem.landmarks = static_cast<int>(2 * x_m.size());
    for (const double from_m : {0.0, on_m})
      for (const double x : x_m) point.landmarks.emplace_back(from_m + x, 3.0);
    problem.robots.resize(1);
    point.nodes.resize(1);
    for (int node = 0; node < 21 + nodes; ++node) {
      const bool again = node >= 21;
      const double at_m = node % 21 + (again ? on_m : 0.0);
      problem.robots[0].time_s.push_back(10.0 * node);
      point.nodes[0].emplace_back(at_m, 0.0, 0.0);
      for (int post = 0; post < static_cast<int>(x_m.size()); ++post) {
        const int landmark = again ? taken_for(post) : post;
        const double ahead_m = x_m[static_cast<std::size_t>(post)] - node % 21;
        if (std::hypot(ahead_m, 3.0) <= 6.0 && sees(node, post))
          problem.sightings.push_back({0, node, landmark, ahead_m, 3.0});
      }
    }
    return FindOneSided(problem, point);
  }
};

int Ghost(int post) { return post + 6; }

TEST(FindOneSided, CountsGhostsAndTheMomentFromWhichTheyAreSeen) {
  const OneSided found = TwoPasses{.on_m = 1.0, .taken_for = Ghost}.Find();
  EXPECT_EQ(found.one_sided, 12);
  EXPECT_EQ(found.two_sided, 0);
  EXPECT_EQ(found.at_s, 200.0);
}

TEST(FindOneSided, TellsThemFromThoseSeenOnBothSides) {
  EXPECT_EQ(TwoPasses{}.Find().one_sided, 0);
  const OneSided found =
      TwoPasses{.taken_for = [](int post) { return post == 0 || post == 3 ? post : Ghost(post); }}.Find();
  EXPECT_EQ(found.one_sided, 8);
  EXPECT_EQ(found.two_sided, 2);
}

// One post is moved a metre on between the passes: too few to be an excess, and counted all the same.
TEST(FindOneSided, ALandmarkThatMovedIsTwoOnOneSideEach) {
  const OneSided found =
      TwoPasses{.on_m = 1.0, .taken_for = [](int post) { return post == 2 ? Ghost(post) : post; }}.Find();
  EXPECT_EQ(found.one_sided, 0);
  EXPECT_EQ(found.most, 2);
  EXPECT_GE(found.most_at_s, 100.0);  // the last look at the post in the first pass, or later
  EXPECT_LE(found.most_at_s, 200.0);
  EXPECT_EQ(TwoPasses{}.Find().most, 0);
}

TEST(FindOneSided, LandmarksThatTheRobotComesToLateAreNone) {
  EXPECT_EQ((TwoPasses{.on_m = 100.0, .taken_for = Ghost}.Find().one_sided), 0);
}

TEST(FindOneSided, FewObservationsOnOneSideProveNothing) {
  EXPECT_EQ((TwoPasses{.nodes = 2, .on_m = 1.0, .taken_for = Ghost}.Find().one_sided), 0);
  EXPECT_GT((TwoPasses{.nodes = 8, .on_m = 1.0, .taken_for = Ghost}.Find().one_sided), 0);
}

// Each is seen once in the first pass, and would be once in the second.
TEST(FindOneSided, WhatIsSeldomSeenThoughLookedAtIsNone) {
  const TwoPasses seldom{
      .on_m = 1.0, .taken_for = Ghost, .sees = [](int node, int post) { return node % 21 == 3 * post + 2; }};
  EXPECT_EQ(seldom.Find().one_sided, 0);
}

// Through the pipeline: half-way the robot is turned, and odometry does not say so. What it sees from then on
// fits as well as what it saw before.
TEST(FindOneSided, SaysOfAMapWithoutNamesWhenTheRobotWasTurned) {
  const Blob log = PostsLog{.drift_rad_per_m = 0.0, .times = 3}.Make();
  const auto sides_of = [&](double turned_rad) {
    Blob turned = log;
    const auto before = log.Get<double>("robot/0/odometry/turn_rad");
    std::vector<double> turn_rad(before.begin(), before.end());
    turn_rad[turn_rad.size() / 2] += turned_rad;
    turned.PutVector("robot/0/odometry/turn_rad", turn_rad);
    return RunInProcess(LandmarkMap({.starts = 1}), {{"log", std::make_shared<const Blob>(turned)}});
  };
  EXPECT_FALSE(sides_of(0.0)->Has("fit/one_sided"));
  const BlobPtr map = sides_of(0.8);
  ASSERT_TRUE(map->Has("fit/one_sided"));
  EXPECT_GE(map->Scalar<std::int64_t>("fit/one_sided"), 6);
  const auto time_s = log.Get<double>("robot/0/odometry/time_s");
  EXPECT_NEAR(map->Scalar<double>("fit/one_sided_s"), time_s[time_s.size() / 2], 10.0);
}

}  // namespace
}  // namespace cairn::landmark_map
