#include "pipelines/landmark_map/state/schedule.h"

#include <gtest/gtest.h>

#include <vector>

#include "pipelines/landmark_map/round.h"

namespace cairn::landmark_map {
namespace {

TEST(Schedule, IsWhatItWasAfterTheState) {
  const Schedule schedule{Phase::kSummary, 3, 0.4, 2, 1, -12.5, 1.3, 4};
  State state;
  schedule.Store(&state);
  const Schedule again = Schedule::Load(state);
  EXPECT_EQ(again.iteration, 3);
  EXPECT_EQ(again.prefix, 0.4);
  EXPECT_EQ(again.robots, 2);
  EXPECT_EQ(again.settled, 1);
  EXPECT_EQ(again.log_likelihood, -12.5);
  EXPECT_EQ(again.phase, Phase::kSummary);
  EXPECT_EQ(again.growth, 1.3);
  EXPECT_EQ(again.apart, 4);
}

TEST(Schedule, ThePrefixGrowsToAllThenIterationsCountThenTheOtherRobotsJoinThenItEnds) {
  const Options options{.iterations = 2, .tolerance = 0.0};
  Schedule s;
  s.prefix = 0.3;
  double likelihood = -100.0;
  const auto next = [&] { return s = s.Next(options, 3, likelihood += 1.0, 100.0); };
  EXPECT_DOUBLE_EQ(next().prefix, 0.6);
  EXPECT_DOUBLE_EQ(next().prefix, 1.0);
  EXPECT_EQ(s.settled, 0);
  EXPECT_EQ(next().settled, 1);
  EXPECT_EQ(s.robots, 1);
  EXPECT_EQ(next().robots, 3);
  EXPECT_EQ(s.settled, 0);
  next();
  EXPECT_FALSE(s.summarises());
  EXPECT_TRUE(next().summarises());
  EXPECT_EQ(s.iteration, 6);
}

TEST(Schedule, AnIterationThatChangesLittleEndsThem) {
  const Options options{.iterations = 50, .tolerance = 1e-3};
  Schedule s;
  constexpr double kObservations = 20.0;
  s = s.Next(options, 1, -100.0, kObservations);
  s = s.Next(options, 1, -90.0, kObservations);
  EXPECT_FALSE(s.summarises());
  s = s.Next(options, 1, -89.975, kObservations);
  EXPECT_FALSE(s.summarises());
  s = s.Next(options, 1, -89.96, kObservations);
  EXPECT_TRUE(s.summarises());
}

// Apart robots are for so many iterations after the one in which they join, however little these change, and
// what one robot alone does until it has settled is not held up by it.
TEST(Schedule, RobotsAreApartAfterTheyHaveJoinedAndTogetherBeforeItEnds) {
  const Options options{.iterations = 50, .tolerance = 1e-3};
  Schedule s{.apart = 2};
  std::vector<bool> apart, before;
  const auto settle = [&] {
    s = s.Next(options, 3, -100.0, 20.0);
    apart.push_back(s.is_apart());
    before.push_back(s.comes_before_apart());
  };
  settle();
  settle();
  ASSERT_EQ(s.robots, 3);
  for (int i = 0; i < 4; ++i) settle();
  EXPECT_EQ(apart, (std::vector<bool>{false, false, true, true, false, false}));
  EXPECT_EQ(before, (std::vector<bool>{false, true, true, false, false, false}));
  EXPECT_TRUE(s.summarises());
}

TEST(Schedule, RobotsAreApartWhereLandmarksAreSeenAtADistanceAndHaveNoNames) {
  Settings settings;
  settings.gauge_free = true;
  EXPECT_GT(IterationsApart(settings), 0);
  settings.map.types = 2;
  EXPECT_EQ(IterationsApart(settings), 0);
  settings.joins_by_geometry = true;
  EXPECT_GT(IterationsApart(settings), 0);
  settings.gauge_free = false;
  EXPECT_EQ(IterationsApart(settings), 0);
}

// The first robot once it has been found anywhere; the others also once the map of all has told, for which
// two need not be found anew in every map of one alone.
TEST(Schedule, RobotsStartNearWhereTheyWereOnceTheyAreFound) {
  const auto nearby = [](std::int64_t robots, std::size_t robot, std::int64_t apart) {
    Schedule s{.robots = robots, .apart = apart};
    std::vector<bool> rounds;
    for (s.settled = 0; s.settled < 5; ++s.settled) rounds.push_back(s.StartsNearby(robot));
    return rounds;
  };
  EXPECT_EQ(nearby(2, 0, 3), (std::vector<bool>{false, true, true, true, true}));
  EXPECT_EQ(nearby(2, 1, 2), (std::vector<bool>{false, true, true, false, true}));
  EXPECT_EQ(nearby(3, 0, 3), (std::vector<bool>{false, true, true, true, true}));
  EXPECT_EQ(nearby(3, 2, 2), (std::vector<bool>{false, false, false, false, true}));
  for (const std::size_t robot : {0U, 1U}) {
    EXPECT_EQ(nearby(2, robot, 0), std::vector<bool>(5))
        << "names say where it is, or a button is all it has";
    EXPECT_EQ(nearby(1, robot, 3), std::vector<bool>(5)) << "alone";
  }
}

TEST(StepsInUse, AtLeastOneAndAllForTheSummary) {
  Schedule s;
  s.prefix = 0.05;
  EXPECT_EQ(StepsInUse(s, 10), 1);
  EXPECT_EQ(StepsInUse(s, 101), 6);
  s.phase = Phase::kSummary;
  EXPECT_EQ(StepsInUse(s, 101), 101);
}

}  // namespace
}  // namespace cairn::landmark_map
