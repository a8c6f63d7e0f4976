#include "pipelines/landmark_map/model/steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pipelines/common/odometry.h"
#include "pipelines/landmark_map/testing.h"
#include "schema/kinds/kind.h"

namespace cairn::landmark_map {
namespace {

using Numbers = std::vector<double>;

const StepRules kRules{4.0, 1.0, 0.5, 2};

// Two metres ahead, a left turn, two metres: controls of one metre.
kinds::Log::Robot Robot(const std::vector<double>& seen_s, const std::vector<std::int32_t>& landmark,
                        const std::vector<double>& range, const std::vector<double>& bearing) {
  kinds::Log::Robot robot;
  robot.odometry = {Numbers{1, 2, 3, 4}, Numbers{0, 0, std::numbers::pi / 2, 0}, Numbers{1, 1, 1, 1}};
  robot.observations = {seen_s, range, bearing, landmark, {}};
  return robot;
}

const double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Integrate, TurnsFirstThenGoes) {
  const Odometry odometry = Integrate(Robot({}, {}, {}, {}).odometry, "a");
  EXPECT_NEAR(odometry.x_m.back(), 2.0, 1e-12);
  EXPECT_NEAR(odometry.y_m.back(), 2.0, 1e-12);
  const OdometricPose half = PoseAt(odometry, 2.5);
  EXPECT_NEAR(half.y_m, 0.5, 1e-12);
  EXPECT_NEAR(half.heading_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(half.path_m, 2.5, 1e-12);
}

// A control with motion began before its end, so the path, too, begins before the log's first time.
TEST(Integrate, ThePathBeginsWhereTheRobotFirstStoodOrBeganToMove) {
  kinds::Log::Robot robot = Robot({}, {}, {}, {});
  EXPECT_EQ(Integrate(robot.odometry, "a").time_s.front(), 0.0);
  robot.odometry.forward_m = Numbers{0, 1, 1, 1};
  EXPECT_EQ(Integrate(robot.odometry, "a").time_s.front(), 1.0);
  EXPECT_EQ(MakeSteps(robot, "a", kRules, nullptr).time_s.front(), 1.0);
  robot.odometry.turn_rad = Numbers{0.1, 0, 0, 0};
  EXPECT_EQ(Integrate(robot.odometry, "a").time_s.front(), 0.0);
}

TEST(Integrate, WhatIsSeenAsAControlEndsIsSeenBeforeTheNextOneTurns) {
  const Odometry odometry = Integrate(Robot({}, {}, {}, {}).odometry, "a");
  EXPECT_EQ(PoseAt(odometry, 2.0).heading_rad, 0.0);
  EXPECT_EQ(PoseAt(odometry, 2.0).turn_rad, 0.0);
  EXPECT_NEAR(PoseAt(odometry, std::nextafter(2.0, 3.0)).heading_rad, std::numbers::pi / 2, 1e-12);
}

TEST(MakeSteps, AContactStandsAtTheRobotAndLongDistancesAreSplit) {
  const RobotSteps steps = MakeSteps(Robot({2.0}, {-1}, {kNaN}, {kNaN}), "a", {1.5, 1.0, 0.5, 2}, nullptr);
  ASSERT_EQ(steps.size(), 5);  // start, 1 m, 2 m (contact detection), 3 m, end
  EXPECT_NEAR(steps.odo_x_m[2], 2.0, 1e-12);
  EXPECT_EQ(steps.first_observation[2], 0);
  EXPECT_EQ(steps.first_observation[3], 1);
  EXPECT_EQ(steps.observations[0].type, 2);  // identity unknown
  EXPECT_EQ(steps.observations[0].x_m, 0.0);
  EXPECT_EQ(steps.row_observation, std::vector<std::int32_t>{0});
  EXPECT_NEAR(steps.IncrementTo(4).dy_m, 1.0, 1e-12);
}

// Seen at 2.0 s from (2, 0) and at 2.25 s from (2, 0.25) after the turn: one landmark, one mean vector.
TEST(MakeSteps, GathersObservationsOfOneFrameInTheOdometricFrame) {
  const double quarter = std::numbers::pi / 2;
  const RobotSteps steps =
      MakeSteps(Robot({2.25, 2.5}, {1, 1}, {1.0, 1.0}, {0.0, -quarter}), "a", {4.0, 1.0, 0.5, 2}, nullptr);
  ASSERT_EQ(steps.observations.size(), 1U);
  EXPECT_EQ(steps.observations[0].type, 1);
  // Step at 2.5 s, (2, 0.5): the first points to (2, 1.25), the second to (3, 0.5).
  EXPECT_NEAR(steps.observations[0].x_m, 0.5, 1e-12);
  EXPECT_NEAR(steps.observations[0].y_m, 0.375, 1e-12);
  EXPECT_EQ(steps.row_observation, (std::vector<std::int32_t>{0, 0}));
}

// Range-bearing observations of a landmark at (3, 2.5), without error, after so many metres travelled.
kinds::Log::Robot RobotThatSeesALandmark(const std::vector<double>& after_m) {
  const Odometry odometry = Integrate(Robot({}, {}, {}, {}).odometry, "a");
  std::vector<double> range, bearing;
  for (const double time_s : after_m) {  // a metre a second
    const OdometricPose at = PoseAt(odometry, time_s);
    const double dx = 3.0 - at.x_m, dy = 2.5 - at.y_m;
    range.push_back(std::hypot(dx, dy));
    bearing.push_back(std::atan2(dy, dx) - at.heading_rad);
  }
  return Robot(after_m, std::vector<std::int32_t>(after_m.size(), 1), range, bearing);
}

// However many range-bearing observations a frame gathers, from wherever: what is at a step points to where
// the landmark stands.
TEST(MakeSteps, ObservationsWithoutErrorPointToTheirLandmarkFromTheStepThatGathersThem) {
  const kinds::Log::Robot robot = RobotThatSeesALandmark({0.3, 0.5, 1.0, 1.4, 1.7, 2.2, 2.9, 3.1, 3.6});
  for (const double frame_m : {0.25, 0.75, 1.5, 3.5}) {
    const RobotSteps steps = MakeSteps(robot, "a", {9.0, frame_m, 9.0, 2}, nullptr);
    for (int s = 0; s < steps.size(); ++s) {
      for (int k = steps.first_observation[s]; k < steps.first_observation[s + 1]; ++k) {
        EXPECT_NEAR(steps.odo_x_m[s] + steps.observations[k].x_m, 3.0, 1e-12) << frame_m << ' ' << s;
        EXPECT_NEAR(steps.odo_y_m[s] + steps.observations[k].y_m, 2.5, 1e-12) << frame_m << ' ' << s;
      }
    }
  }
}

// Five range-bearing observations, the turn of half pi between the second and the third: a frame holds
// frame_m travelled or frame_rad of turn, each alone.
TEST(MakeSteps, AFrameIsSoMuchWayOrSoMuchTurn) {
  const kinds::Log::Robot robot = RobotThatSeesALandmark({0.5, 1.9, 2.1, 2.9, 3.1});
  const auto rows = [&](double frame_m, double frame_rad) {
    return MakeSteps(robot, "a", {9.0, frame_m, frame_rad, 2}, nullptr).row_observation;
  };
  using Rows = std::vector<std::int32_t>;
  EXPECT_EQ(rows(0.15, 1e9), (Rows{0, 1, 2, 3, 4}));
  EXPECT_EQ(rows(0.25, 1e9), (Rows{0, 1, 1, 2, 2}));
  EXPECT_EQ(rows(2.5, 1e9), (Rows{0, 0, 0, 0, 1}));
  EXPECT_EQ(rows(2.7, 1e9), (Rows{0, 0, 0, 0, 0}));
  EXPECT_EQ(rows(1e9, 1.5), (Rows{0, 0, 1, 1, 1}));
  EXPECT_EQ(rows(1e9, 1.6), (Rows{0, 0, 0, 0, 0}));
}

TEST(MakeSteps, ALateRobotBeginsWhereItSeesWhatTheFirstRobotSaw) {
  const std::vector<bool> shared = {false, true, false};
  const kinds::Log::Robot robot = Robot({1.0, 3.0}, {0, 1}, {1, 1}, {0, 0});
  const RobotSteps steps = MakeSteps(robot, "b", kRules, &shared);
  EXPECT_EQ(steps.time_s[0], 3.0);
  EXPECT_EQ(steps.row_observation, (std::vector<std::int32_t>{-1, 0}));
  const std::vector<bool> none = {false, false, false};
  EXPECT_THROW(MakeSteps(robot, "b", kRules, &none), InputError);
}

// Odometry bends a straight way by its drift: taking the drift off straightens it, range-bearing observations
// too. schema/FORMAT.md: a control's time is its end, so a contact detection at that time stands after it;
// several may end at once.
TEST(PoseAt, AnObservationAtAControlsEndStandsAfterIt) {
  const Odometry odometry = Integrate(Robot({}, {}, {}, {}).odometry, "a");
  EXPECT_NEAR(PoseAt(odometry, 1.0).x_m, 1.0, 1e-12);
  EXPECT_NEAR(PoseAt(odometry, 0.5).x_m, 0.5, 1e-12);
  EXPECT_NEAR(PoseAt(odometry, -3.0).x_m, 0.0, 1e-12);
  EXPECT_NEAR(PoseAtPath(odometry, 2.5).y_m, 0.5, 1e-12);
  kinds::Log::Robot at_once = Robot({}, {}, {}, {});
  at_once.odometry.time_s = Numbers{1, 2, 2, 2};
  EXPECT_NEAR(PoseAt(Integrate(at_once.odometry, "a"), 2.0).y_m, 2.0, 1e-12);
}

TEST(MakeSteps, SplitsALongWayThatAControlMakesInAnInstant) {
  kinds::Log::Robot robot = Robot({2.0}, {-1}, {kNaN}, {kNaN});
  robot.odometry.time_s = Numbers{1, 1, 1, 2};
  const RobotSteps steps = MakeSteps(robot, "a", {0.5, 1.0, 0.5, 2}, nullptr);
  for (int s = 1; s < steps.size(); ++s) EXPECT_LE(steps.path_m[s], 0.5 + 1e-9) << s;
  EXPECT_NEAR(steps.odo_y_m.back(), 2.0, 1e-12);
}

TEST(WithoutDrift, StraightensAWayThatOdometryBends) {
  const double drift = 0.05;
  std::vector<double> time, turn, forward;
  for (int i = 1; i <= 200; ++i) {
    time.push_back(i);
    turn.push_back(drift * 0.1);
    forward.push_back(0.1);
  }
  kinds::Log::Robot robot = Robot({200.0}, {0}, {2.0}, {0.0});
  robot.odometry.time_s = time;
  robot.odometry.turn_rad = turn;
  robot.odometry.forward_m = forward;
  const RobotSteps bent = MakeSteps(robot, "a", {0.5, 1.0, 0.5, 2}, nullptr);
  const RobotSteps straight = bent.WithoutDrift(drift);
  EXPECT_GT(std::abs(bent.odo_y_m.back()), 5.0);
  EXPECT_NEAR(straight.odo_x_m.back(), 20.0, 0.01);
  EXPECT_NEAR(straight.odo_y_m.back(), 0.0, 0.06);
  EXPECT_NEAR(straight.observations[0].y_m, 0.0, 0.01);
  EXPECT_EQ(BlobOf(bent.WithoutDrift(0.0)).ContentHash(), BlobOf(bent).ContentHash());
}

TEST(MakeSteps, BlobsGiveTheSameStepsBack) {
  const RobotSteps steps = MakeSteps(Robot({1.0, 3.0}, {0, 1}, {1, 1}, {0, 0}), "a", kRules, nullptr);
  EXPECT_EQ(BlobOf(Read<RobotSteps>(BlobOf(steps))).ContentHash(), BlobOf(steps).ContentHash());
}

// As a worker hands it on.
kinds::Log::Robot Checked(const kinds::Log::Robot& robot) {
  kinds::Log log;
  log.robots = Texts(std::vector<std::string>{"rover"});
  log.landmarks = Texts(std::vector<std::string>{"a", "b"});
  log.types = Texts(std::vector<std::string>{"door", "lamp", "bin"});
  log.robot = {robot};
  const Blob blob = BlobOf(log);
  CheckInput(blob, "log");
  return Read<kinds::Log>(blob).robot[0];
}

TEST(MakeSteps, BadLogsAreRefusedWithRobotRowAndReason) {
  const auto refusal = [](const kinds::Log::Robot& robot) -> std::string {
    try {
      MakeSteps(Checked(robot), "rover", kRules, nullptr);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  const auto has = [&](const kinds::Log::Robot& robot, const char* reason) {
    const std::string what = refusal(robot);
    EXPECT_NE(what.find("rover"), std::string::npos) << what;
    EXPECT_NE(what.find(reason), std::string::npos) << what;
  };
  const auto unfit = [&](const kinds::Log::Robot& robot, const std::string& reason) {
    EXPECT_EQ(refusal(robot).find("input 'log': 'robot/0/" + reason), 0U) << refusal(robot);
  };
  has(Robot({-5.0}, {-1}, {kNaN}, {kNaN}), "before the first control");
  has(Robot({50.0}, {-1}, {kNaN}, {kNaN}), "after the last control");
  unfit(Robot({2.0, 1.0}, {-1, -1}, {kNaN, kNaN}, {kNaN, kNaN}), "observations/time_s', entry 1: 1 after 2");
  unfit(Robot({kNaN}, {-1}, {kNaN}, {kNaN}), "observations/time_s': nan, where a finite number is needed");
  unfit(Robot({2.0}, {7}, {kNaN}, {kNaN}),
        "observations/landmark': 7, where a row of 'landmarks', which has 2");
  has(Robot({2.0}, {1}, {3.0}, {kNaN}), "range without bearing");
  unfit(Robot({2.0}, {1}, {-3.0}, {0.0}), "observations/range_m': -3");
  kinds::Log::Robot backwards = Robot({}, {}, {}, {});
  backwards.odometry.time_s = Numbers{1, 2, 1.5, 4};
  unfit(backwards, "odometry/time_s', entry 2: 1.5 after 2");
  kinds::Log::Robot hollow = Robot({}, {}, {}, {});
  hollow.odometry.forward_m = Numbers{1, kNaN, 1, 1};
  unfit(hollow, "odometry/forward_m', entry 1: nan");
  kinds::Log::Robot wild = Robot({}, {}, {}, {});
  wild.odometry.forward_m = Numbers{1, 1e8, 1, 1};
  has(wild, "control 1: a distance or turn too large");
  kinds::Log::Robot empty = Robot({}, {}, {}, {});
  empty.odometry = {Numbers(), Numbers(), Numbers()};
  has(empty, "no controls");
}

// Two identities, then three types: an observation with an identity is of its layer, others of their type's.
TEST(MakeSteps, TypesHaveLayersBehindTheIdentities) {
  kinds::Log::Robot robot = Robot({1.0, 2.0, 4.0}, {-1, 1, -1}, {kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN});
  StepRules rules = kRules;
  rules.classes = 3;
  EXPECT_THROW(MakeSteps(robot, "a", rules, nullptr), InputError);
  using Types = std::vector<std::int32_t>;
  robot.observations.type = Types{2, 0, 1};
  const RobotSteps steps = MakeSteps(robot, "a", rules, nullptr);
  ASSERT_EQ(steps.observations.size(), 3U);
  EXPECT_EQ(steps.observations[0].type, 4);
  EXPECT_EQ(steps.observations[1].type, 1);
  EXPECT_EQ(steps.observations[2].type, 3);
  for (const Types& wrong : {Types{2, 0, 3}, {-1, 0, 0}, {0, 0}}) {
    robot.observations.type = wrong;
    EXPECT_THROW(MakeSteps(Checked(robot), "a", rules, nullptr), InputError);
  }
}

TEST(MakeSteps, LaterDataAreLeftOut) {
  const kinds::Log::Robot robot = Robot({1.0, 2.0, 4.0}, {0, 1, -1}, {kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN});
  StepRules rules = kRules;
  rules.until_s = 2.0;
  const RobotSteps steps = MakeSteps(robot, "a", rules, nullptr);
  ASSERT_EQ(steps.observations.size(), 2U);
  EXPECT_EQ(steps.row_observation, (std::vector<std::int32_t>{0, 1, -1}));
  EXPECT_EQ(steps.time_s.back(), 2.0);
  rules.until_s = 3.5;  // between two controls
  EXPECT_NEAR(MakeSteps(robot, "a", rules, nullptr).odo_y_m.back(), 1.5, 1e-12);
}

}  // namespace
}  // namespace cairn::landmark_map
