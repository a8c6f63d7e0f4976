#include "datasets/common/log_parts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/common/control.h"
#include "datasets/evaluate/track.h"
#include "datasets/simulate/loop.h"

namespace cairn::datasets {
namespace {

Pose DeadReckoned(const Blob& log, Pose pose) {
  const auto turn = log.Get<double>("robot/0/odometry/turn_rad");
  const auto forward = log.Get<double>("robot/0/odometry/forward_m");
  for (std::size_t i = 0; i < turn.size(); ++i) pose = Apply(pose, {turn[i], forward[i]});
  return pose;
}

TEST(LogParts, RobotsKeepTheirDataAndTruthUnderNewNumbers) {
  const Blob log = SimulateLoop({.robots = 3, .seed = 4});
  const Blob part = RobotsOf(log, {2, 0});
  EXPECT_EQ(part.Texts("robots"), (std::vector<std::string>{log.Texts("robots")[2], log.Texts("robots")[0]}));
  EXPECT_TRUE(part.at("robot/0/odometry/turn_rad") == log.at("robot/2/odometry/turn_rad"));
  EXPECT_TRUE(part.at("truth/robot/1/poses/x_m") == log.at("truth/robot/0/poses/x_m"));
  EXPECT_TRUE(part.at("truth/landmarks/x_m") == log.at("truth/landmarks/x_m"));
  EXPECT_FALSE(part.Has("robot/2/odometry/turn_rad"));
  EXPECT_THROW(RobotsOf(log, {3}), InputError);
}

TEST(LogParts, AReversedDriveLeadsBackToItsStart) {
  const Blob log = SimulateLoop({.difficulty = "paper", .seed = 4});
  const Blob back = Reversed(log, 0);
  const Pose start{3.0, -2.0, 0.7};
  const Pose there = DeadReckoned(log, start), again = DeadReckoned(back, there);
  EXPECT_GT(std::hypot(there.x_m - start.x_m, there.y_m - start.y_m), 1.0);
  EXPECT_NEAR(again.x_m, start.x_m, 1e-9);
  EXPECT_NEAR(again.y_m, start.y_m, 1e-9);
  EXPECT_NEAR(again.heading_rad, start.heading_rad, 1e-9);
  const auto time_s = back.Get<double>("robot/0/odometry/time_s");
  for (std::size_t i = 1; i < time_s.size(); ++i) EXPECT_GE(time_s[i], time_s[i - 1]) << i;
}

// The pose at the n-th last observation is that of the reversed log's n-th.
TEST(LogParts, AReversedDrivePassesItsObservationsWhereTheyWereMade) {
  const Blob log = SimulateLoop({.difficulty = "paper", .seed = 4});
  const auto at = [](const Blob& b, std::size_t observation, Pose pose) {
    const auto time = b.Get<double>("robot/0/odometry/time_s"),
               turn = b.Get<double>("robot/0/odometry/turn_rad"),
               forward = b.Get<double>("robot/0/odometry/forward_m");
    const double until_s = b.Get<double>("robot/0/observations/time_s")[observation];
    for (std::size_t i = 0; i < time.size() && time[i] <= until_s + 1e-6; ++i)
      pose = Apply(pose, {turn[i], forward[i]});
    return pose;
  };
  const std::size_t seen = log.Get<double>("robot/0/observations/time_s").size();
  const Pose end = DeadReckoned(log, {});
  const Blob back = Reversed(log, 0);
  for (const std::size_t n : {std::size_t{0}, seen / 2, seen - 2}) {
    const Pose there = at(log, n, {}), here = at(back, seen - 1 - n, end);
    EXPECT_NEAR(there.x_m, here.x_m, 1e-6) << n;
    EXPECT_NEAR(there.y_m, here.y_m, 1e-6) << n;
  }
}

// Where it truly was when it made an observation, and which landmark that was of, is the same either way.
TEST(LogParts, AReversedDriveKeepsItsTruth) {
  const Blob log = SimulateLoop({.difficulty = "paper", .seed = 4}), back = Reversed(log, 0);
  const Track forth_track = ReadTrack(log, "truth/robot/0/poses/"),
              back_track = ReadTrack(back, "truth/robot/0/poses/");
  const auto forth_s = log.Get<double>("robot/0/observations/time_s"),
             back_s = back.Get<double>("robot/0/observations/time_s");
  const auto forth_of = log.Get<std::int32_t>("truth/robot/0/observations/landmark"),
             back_of = back.Get<std::int32_t>("truth/robot/0/observations/landmark");
  ASSERT_EQ(back_s.size(), forth_s.size());
  for (std::size_t n = 0; n < forth_s.size(); ++n) {
    const std::size_t m = forth_s.size() - 1 - n;
    EXPECT_EQ(back_of[m], forth_of[n]);
    const auto there = PoseAt(forth_track, forth_s[n]), here = PoseAt(back_track, back_s[m]);
    ASSERT_TRUE(there && here) << n;
    EXPECT_NEAR(there->x_m, here->x_m, 1e-6) << n;
    EXPECT_NEAR(there->y_m, here->y_m, 1e-6) << n;
  }
}

}  // namespace
}  // namespace cairn::datasets
