#include "pipelines/landmark_map/outlook.h"

#include <gtest/gtest.h>

#include <cmath>

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
  robot_states.refined_rows.assign(robots, 0.0);
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

// Most of the work of a long log with many landmarks, whose E-steps go fast.
TEST(ExpectEm, LeastSquaresOverObservationsAtADistanceTakesAsLongAsTheirRowsAndLandmarksSay) {
  RobotStates robot_states = OfRobots(1);
  const auto refinement = [&](double rows, std::int64_t landmarks) {
    robot_states.refined_rows[0] = rows;
    robot_states.landmarks = landmarks;
    proto::Step plan;
    ExpectEm({}, {.phase = Phase::kSummary}, robot_states, &plan);
    return plan;
  };
  EXPECT_EQ(refinement(0.0, 600).advance_cost(), kRefinementUs * 1000) << "contact detections: by the steps";
  for (const int landmarks : {0, 600}) {
    const double all = (kRefinedRowUs + landmarks * kRefinedRowAndLandmarkUs) * 5e4;
    const proto::Step plan = refinement(5e4, landmarks);
    EXPECT_EQ(plan.advance_cost() + CostLater(plan), all);
    ASSERT_EQ(plan.later_size(), 1);
    const proto::Phase& more = plan.later(0);  // that it may take, or not
    EXPECT_EQ(more.least() * more.cost(), 0.0);
    EXPECT_LT(plan.advance_cost(), 0.6 * all);
    EXPECT_GT(plan.advance_cost() + more.most() * more.cost(), 1.6 * all);
  }
}

// One worker has it, however many robots there are, and no E-step follows it.
TEST(ExpectEm, LeastSquaresOverObservationsAtADistanceIsAPhaseOfItsOwnAndTheLast) {
  RobotStates robot_states = OfRobots(4);
  proto::Step contacts, ranges, summary;
  ExpectEm({}, {}, robot_states, &contacts);
  robot_states.refined_rows = {1e4, 0.0, 1e4, 0.0};
  ExpectEm({}, {}, robot_states, &ranges);
  ASSERT_EQ(ranges.later_size(), contacts.later_size() + 1);
  const proto::Phase& last = ranges.later(ranges.later_size() - 1);
  EXPECT_EQ(last.cost(), kRefinedRowUs * 2e4);
  EXPECT_EQ(last.width(), 1);
  EXPECT_EQ(last.rounds(), 0);
  EXPECT_LT(RoundsLater(ranges), RoundsLater(contacts));
  ExpectEm({}, {.phase = Phase::kSummary}, robot_states, &summary);
  EXPECT_EQ(RoundsLater(summary), 0);
  EXPECT_EQ(summary.advance_cost() + CostLater(summary), last.cost());
}

TEST(RefinedRows, CountsThoseAtADistanceTwiceWhereTheyHaveNoName) {
  const double nan = std::nan("");
  kinds::Log::Observations seen;
  seen.range_m = std::vector<double>{nan, 2.0, 3.0, 4.0};
  seen.landmark = std::vector<std::int32_t>{0, 0, 1, -1};
  EXPECT_EQ(RefinedRows(seen), 2 + 2);
  seen.range_m = std::vector<double>{nan, nan, nan, nan};
  EXPECT_EQ(RefinedRows(seen), 0.0);
}

// Through the pipeline: the State says how many landmarks the map of the round before has.
TEST(ExpectEm, LeastSquaresIsExpectedOfTheMapThatThereIs) {
  const SquareLog square{.laps = 3, .side_m = 10.0, .ranged = true, .identified = true};
  std::vector<double> costs;
  RunInProcess(LandmarkMap({.cell_m = 0.5}), {{"log", std::make_shared<const Blob>(square.Make())}},
               [&](const proto::Step& step) {
                 if (step.advance_cost() > 0.0) costs.push_back(step.advance_cost() + CostLater(step));
               });
  const double rows = 3 * 4, landmarks = 4;
  EXPECT_EQ(costs, std::vector{rows * (kRefinedRowUs + landmarks * kRefinedRowAndLandmarkUs)});
}

// Searched or not: what is told of the candidates knows the refinement that ends the job.
TEST(SearchOutlook, KnowsTheLeastSquares) {
  const auto last_of = [](bool ranged) {
    const auto log = std::make_shared<const Blob>(SquareLog{.side_m = 20.0, .ranged = ranged}.Make());
    const Step step = LandmarkMap({.cell_m = 1.0, .starts = 10}).Start(MapInputs({{"log", log}}));
    return step.plan.later(step.plan.later_size() - 1);
  };
  EXPECT_EQ(last_of(true).rounds(), 0.0);
  EXPECT_EQ(last_of(true).cost(), 2.0 * 3 * 4 * kRefinedRowUs)
      << "of rows without names, before there is a map";
  EXPECT_GT(last_of(false).rounds(), 0.0);
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
