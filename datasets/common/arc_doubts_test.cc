#include "datasets/common/arc_doubts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/common/motion_doubts.h"
#include "schema/geometry.h"
#include "schema/kinds/odometry_steps.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

struct Winding {
  bool turns_along = true;  // the robot; the rows are the same
  double step_s = 0.5, mount_x_m = 0;
  bool is_named = true;
  std::uint64_t seed = 1;
};

constexpr double kSpeed_mps = 0.8;

// A robot that winds among forty poles, and sees those ahead of it once a second.
kinds::Log::Robot RobotOf(const Winding& drive) {
  constexpr int kLandmarks = 40, kSeconds = 160;
  Rng random(drive.seed);
  std::vector<Point> poles;
  for (int k = 0; k < kLandmarks; ++k)
    poles.push_back({random.Uniform() * 30 - 15, random.Uniform() * 30 - 15});
  std::vector<double> time_s, turn_rad, forward_m, seen_s, range_m, bearing_rad;
  std::vector<std::int32_t> landmark;
  Pose pose;
  for (int i = 0; i * drive.step_s < kSeconds; ++i) {
    const double now_s = i * drive.step_s;
    const double turn = drive.step_s * (0.35 * std::sin(now_s / 3.7) + 0.25 * std::sin(now_s / 1.45));
    const double way = kSpeed_mps * drive.step_s;
    time_s.push_back(now_s);
    turn_rad.push_back(turn);
    forward_m.push_back(way);
    pose = drive.turns_along
               ? Compose(Compose(Compose(pose, {0, 0, turn / 2}), {ChordOfArc(way, turn), 0, 0}),
                         {0, 0, turn / 2})
               : Compose(Compose(pose, {0, 0, turn}), {way, 0, 0});
    if (std::fmod(now_s, 1) != 0) continue;
    for (std::size_t k = 0; k < poles.size(); ++k) {
      const Pose seen = Between(Compose(pose, {drive.mount_x_m, 0, 0}), {poles[k].x_m, poles[k].y_m, 0});
      if (seen.x_m <= 0 || std::hypot(seen.x_m, seen.y_m) > 6) continue;
      seen_s.push_back(now_s);
      range_m.push_back(std::hypot(seen.x_m, seen.y_m) + 0.03 * random.Normal());
      bearing_rad.push_back(std::atan2(seen.y_m, seen.x_m) + 0.01 * random.Normal());
      landmark.push_back(drive.is_named ? static_cast<std::int32_t>(k) : -1);
    }
  }
  kinds::Log::Robot robot;
  robot.odometry = {time_s, turn_rad, forward_m};
  robot.observations = {seen_s, range_m, bearing_rad, landmark, {}};
  return robot;
}

std::string DoubtOf(const Winding& drive) {
  const kinds::Log::Robot robot = RobotOf(drive);
  return DoubtSteps(robot.observations, robot.odometry).value_or("");
}

TEST(ArcDoubts, ARobotThatTurnsWhileItGoesShowsWithNamesAndWithout) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const double step_s : {0.25, 0.5, 1.0})
      for (const bool is_named : {true, false})
        EXPECT_NE(DoubtOf({.step_s = step_s, .is_named = is_named, .seed = seed}).find("`--steps-are-arcs`"),
                  std::string::npos)
            << "seed " << seed << ", " << step_s << " s, " << is_named;
}

TEST(ArcDoubts, OneThatTurnsFirstIsNotInDoubt) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const double step_s : {0.1, 0.25, 0.5, 1.0})
      for (const bool is_named : {true, false})
        EXPECT_EQ(DoubtOf({.turns_along = false, .step_s = step_s, .is_named = is_named, .seed = seed}), "");
}

TEST(ArcDoubts, NorStepsThatAreTooShortToMatter) { EXPECT_EQ(DoubtOf({.step_s = 0.05}), ""); }

TEST(ArcDoubts, NorASensorThatSitsFartherBehindThanStepsExplain) {
  EXPECT_EQ(DoubtOf({.turns_along = false, .mount_x_m = -0.6}), "");
}

TEST(ArcDoubts, TheShareIsOneOfArcsAndNoneOfRowsThatTurnFirst) {
  for (const bool turns_along : {true, false}) {
    const kinds::Log::Robot robot = RobotOf({.turns_along = turns_along});
    const std::optional<StepArcs> found = FindStepArcs(robot.observations, robot.odometry);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->share, turns_along ? 1 : 0, 0.1);
    EXPECT_NEAR(found->half_step_m, 0.2, 1e-9);
    EXPECT_GT(found->sd, 0);
    EXPECT_LT(found->sd, 0.1);
  }
}

TEST(ArcDoubts, TheLogsMotionIsInDoubtForIt) {
  kinds::Log log;
  log.robots = std::vector<std::string>{"anna"};
  log.robot = {RobotOf({})};
  const std::vector<std::string> doubts = FindMotionDoubts(log);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_TRUE(doubts.front().starts_with("robot 'anna', its observations: of "));
  EXPECT_NE(doubts.front().find("--steps-are-arcs"), std::string::npos);
}

}  // namespace
}  // namespace cairn::datasets
