#include "pipelines/landmark_map/outlook.h"

#include <gtest/gtest.h>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

constexpr double kWork = 1e6;  // cells of the first robot's E-step

RobotStates OfRobots(std::size_t robots) {
  RobotStates robot_states;
  robot_states.step_counts.assign(robots, 1000);
  robot_states.work.assign(robots, kWork);
  robot_states.sharp.assign(robots, kWork);  // as sharp as it gets
  return robot_states;
}

proto::Step Outlook(const Options& options, const Schedule& schedule, std::size_t robots = 1) {
  proto::Step plan;
  ExpectEm(options, schedule, OfRobots(robots), &plan);
  return plan;
}

TEST(ExpectEm, AnnouncesThePrefixUsualIterationsAndTheSummaries) {
  const proto::Step plan = Outlook({}, {.prefix = 0.25});
  ASSERT_EQ(plan.later_size(), 2);
  EXPECT_EQ(plan.later(0).rounds(), 2 + 5 - 1) << "half of the data, all of them, four more times";
  EXPECT_GT(plan.later(1).rounds(), 1) << "the summary, and perhaps again in the refined map";
  const double step = kBackwardUs * kWork / 250;
  EXPECT_NEAR(plan.later(0).cost(), step * (500 + 5 * 1000) + 6 * kMStepUs, 1);
  EXPECT_NEAR(plan.later(1).cost(), step * plan.later(1).rounds() * 1000 + kRefinementUs * 1000, 1);
}

TEST(ExpectEm, BeliefsGetNarrowerDownToASharpMaps) {
  RobotStates robot_states = OfRobots(1);
  robot_states.sharp[0] = 0.3 * kWork / 1000;
  proto::Step plan;
  ExpectEm({.iterations = 4}, {}, robot_states, &plan);
  const double step = kBackwardUs * kWork;
  EXPECT_NEAR(plan.later(0).cost(), step * (0.5 + 0.3 + 0.3) + 3 * kMStepUs, 1);
}

TEST(ExpectEm, NoMoreThanIsAllowedAndOneMoreWhereEmGoesOn) {
  EXPECT_EQ(Outlook({.iterations = 2}, {}).later(0).rounds(), 1);
  EXPECT_EQ(Outlook({.iterations = 50}, {.settled = 20}).later_size(), 1) << "the last one is under way";
}

TEST(ExpectEm, RobotsThatJoinComeAfterTheFirst) {
  const proto::Step plan = Outlook({}, {}, 3);
  EXPECT_EQ(plan.later(0).rounds(), 4);
  EXPECT_GT(plan.later(1).rounds(), 3 + 1);
  EXPECT_EQ(plan.later(1).width(), 3);
}

TEST(ExpectEm, ARobotThatMayStartAnywhereLooksForItselfInEachIteration) {
  RobotStates robot_states = OfRobots(2);
  robot_states.sharp = {0.0, 0.0};
  proto::Step plan;
  ExpectEm({.refine = false}, {}, robot_states, &plan);
  ASSERT_EQ(plan.later_size(), 2);
  const double each = (plan.later(1).cost() - 5 * kMStepUs) / plan.later(1).rounds();
  EXPECT_NEAR(each, kBackwardUs * kWork, 0.05 * kBackwardUs * kWork) << "the first one knows where it starts";
}

TEST(ExpectEm, NothingFollowsTheLastRound) {
  EXPECT_EQ(Outlook({}, {.phase = Phase::kRefinedSummary}).later_size(), 0);
  EXPECT_EQ(Outlook({.refine = false}, {.phase = Phase::kSummary}).later_size(), 0);
  EXPECT_EQ(Outlook({.incremental = true}, {}).later_size(), 0);
}

// Through the pipeline: the search's later waves were announced by no step.
TEST(SearchOutlook, AnnouncesTheWavesThatAreUsual) {
  const auto log = std::make_shared<const Blob>(SquareLog{.laps = 3, .side_m = 20.0}.Make());
  const auto later = [&](std::int64_t waves) {
    const Step step =
        LandmarkMap({.cell_m = 1.0, .starts = 10, .waves = waves}).Start(MapInputs({{"log", log}}));
    return std::pair(RoundsLater(step.plan), CostLater(step.plan));
  };
  const auto [rounds, cost] = later(0);
  const auto [more_rounds, more_cost] = later(6);
  EXPECT_GT(more_rounds, 1.5 * rounds);
  EXPECT_GT(more_cost, 1.5 * cost);
}

}  // namespace
}  // namespace cairn::landmark_map
