#include "pipelines/landmark_map/first_robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {
namespace {

constexpr double kLittleDrift = 0.002;

PostsLog Rounds(int times, std::uint64_t seed) {
  return {.drift_rad_per_m = kLittleDrift, .seed = seed, .times = times};
}

// Robots whose names say which they are.
Blob LogOf(const std::vector<std::pair<std::string, Blob>>& robots) {
  Blob log = robots.front().second;
  std::vector<std::string> names;
  for (const auto& [name, one] : robots) {
    log.PutAll("robot/" + std::to_string(names.size()) + "/", one.Sub("robot/0/"));
    names.push_back(name);
  }
  log.Put("robots", Array::Texts(names));
  return log;
}

std::vector<std::string> TriedIn(const Blob& log, const Options& options) {
  const MapInputs inputs({{"log", std::make_shared<const Blob>(log)}});
  std::vector<std::string> names;
  for (const std::size_t robot : FirstRobots(options, inputs)) names.push_back(log.Texts("robots")[robot]);
  return names;
}

using Names = std::vector<std::string>;

TEST(FirstRobots, AreThoseThatLookedFromMostPlacesWhateverTheirOrderInTheLog) {
  const Blob little = Rounds(1, 1).Make(), much = Rounds(3, 2).Make(), most = Rounds(4, 3).Make();
  EXPECT_EQ(TriedIn(LogOf({{"little", little}, {"much", much}, {"most", most}}), {.first_robots = 2}),
            (Names{"most", "much"}));
  EXPECT_EQ(TriedIn(LogOf({{"most", most}, {"much", much}, {"little", little}}), {.first_robots = 2}),
            (Names{"most", "much"}));
  EXPECT_EQ(TriedIn(LogOf({{"little", little}, {"much", much}, {"most", most}}), {}), (Names{"little"}))
      << "not known to be better";
  EXPECT_EQ(TriedIn(LogOf({{"much", much}, {"most", most}}), {.first_robots = 3}), (Names{"most", "much"}));
}

TEST(FirstRobots, AreTheLogsFirstAloneWhereThereIsNothingToChoose) {
  const Names first{"one"};
  const auto two = [](const Blob& one, const Blob& other) { return LogOf({{"one", one}, {"two", other}}); };
  const Blob posts = Rounds(1, 1).Make(), more = Rounds(2, 2).Make();
  EXPECT_EQ(TriedIn(LogOf({{"one", posts}}), {}), first);
  EXPECT_EQ(TriedIn(two(posts, more), {.starts = 1}), first);
  EXPECT_EQ(TriedIn(two(posts, more), {.first_robots = 1}), first);
  const Blob contacts = SquareLog{}.Make();
  EXPECT_EQ(TriedIn(two(contacts, SquareLog{.laps = 4}.Make()), {}), first);
  PostsLog named = Rounds(1, 1);
  named.named = true;
  EXPECT_EQ(TriedIn(two(named.Make(), named.Make()), {.starts = 10}), first);
}

// Of three robots the last one comes first; a result of that names robots by their places in it.
TEST(LedBy, PutsOneRobotFirstAndAResultIsPutInOrderAgain) {
  Blob log;
  log.Put("robots", Array::Texts({"a", "b", "c"}));
  for (const std::int32_t r : {0, 1, 2})
    log.PutVector<std::int32_t>("robot/" + std::to_string(r) + "/of", {r});
  log.PutVector<std::int32_t>("robot/1/robot_observations/robot", {0, 2});
  log.PutScalar<double>("noise/range_m", 0.1);
  const MapInputs inputs({{"log", std::make_shared<const Blob>(log)}});
  const BlobPtr led = LedBy(2, inputs).Get("log");
  EXPECT_EQ(led->Texts("robots"), (Names{"c", "a", "b"}));
  EXPECT_EQ(led->Get<std::int32_t>("robot/0/of")[0], 2);
  EXPECT_EQ(led->Get<std::int32_t>("robot/1/of")[0], 0);
  EXPECT_EQ(led->Get<std::int32_t>("robot/2/of")[0], 1);
  EXPECT_EQ(led->Get<std::int32_t>("robot/2/robot_observations/robot")[0], 1);
  EXPECT_EQ(led->Get<std::int32_t>("robot/2/robot_observations/robot")[1], 0);
  EXPECT_EQ(led->Scalar<double>("noise/range_m"), 0.1);
  Blob result = *led;
  result.PutVector<std::int32_t>("holes/robot", {0, 1, 2});
  const Blob ordered = InOrderOf(log, 2, result);
  const auto holes = ordered.Get<std::int32_t>("holes/robot");
  EXPECT_EQ(std::vector<std::int32_t>(holes.begin(), holes.end()), (std::vector<std::int32_t>{2, 0, 1}));
  EXPECT_EQ(ordered.Text("log_hash"), log.ContentHash().Hex());
  EXPECT_EQ(ordered.Without("holes/").Without("log_hash").ContentHash(), log.ContentHash());
}

BlobPtr Map(const Blob& log) {
  const LandmarkMap pipeline({.iterations = 2, .starts = 2, .waves = 0});
  return RunInProcess(pipeline, {{"log", std::make_shared<const Blob>(log)}});
}

// Not to a rounding alone: two robots are tried in either order, each with the other as the second.
TEST(FirstRobots, TheOrderInTheLogChangesNothingButTheRobotsNumbers) {
  const Blob one = Rounds(1, 1).Make(), other = Rounds(2, 2).Make();
  const BlobPtr map = Map(LogOf({{"one", one}, {"other", other}}));
  const BlobPtr turned = Map(LogOf({{"other", other}, {"one", one}}));
  EXPECT_EQ(map->Scalar<std::int32_t>("search/first_robot"),
            1 - turned->Scalar<std::int32_t>("search/first_robot"));
  EXPECT_EQ(map->Text("search/why"), turned->Text("search/why"));
  EXPECT_EQ(map->Sub("map/").ContentHash(), turned->Sub("map/").ContentHash());
  EXPECT_EQ(map->Sub("robot/0/").ContentHash(), turned->Sub("robot/1/").ContentHash());
  EXPECT_EQ(map->Sub("robot/1/").ContentHash(), turned->Sub("robot/0/").ContentHash());
  const auto scores = map->Get<double>("search/tried_score_nats");
  ASSERT_EQ(scores.size(), 2U);
  const std::size_t kept =
      map->Get<std::int32_t>("search/tried_robot")[0] == map->Scalar<std::int32_t>("search/first_robot") ? 0
                                                                                                         : 1;
  EXPECT_GE(scores[kept], scores[1 - kept]);
}

// Six posts with names; for its first 8 s the second robot knows them by other names, which the first one
// never gives.
constexpr std::int32_t kPosts = 6;
constexpr double kElsewhere_s = 8;
BlobPtr TwoOfWhichTheSecondComesFromElsewhere() {
  PostsLog named = Rounds(2, 1);
  named.named = true;
  Blob log = named.Make();
  named.seed = 2;
  Blob second = named.Make();
  const auto seen = Read<kinds::Log>(second).robot[0].observations;
  std::vector<std::int32_t> landmark = seen.landmark.vector();
  for (std::size_t i = 0; i < landmark.size(); ++i)
    if (seen.time_s[i] < kElsewhere_s) landmark[i] += kPosts;
  second.PutVector("robot/0/observations/landmark", landmark);
  std::vector<std::string> names = log.Texts("landmarks");
  for (std::int32_t post = 0; post < kPosts; ++post)
    names.push_back("of the second's " + std::to_string(post));
  log = LogOf({{"first", log}, {"second", second}});
  log.Put("landmarks", Array::Texts(names));
  return std::make_shared<const Blob>(log);
}

TEST(SecondRobots, WhatOneSawBeforeItCameToTheFirstOnesLandmarksIsInTheMap) {
  const BlobPtr log = TwoOfWhichTheSecondComesFromElsewhere();
  const BlobPtr map = RunInProcess(LandmarkMap({.iterations = 4}), {{"log", log}});
  EXPECT_FALSE(map->Has("missing_landmarks"));
  const auto found = Read<kinds::LandmarkMap>(*map);
  const std::vector<std::int32_t> names = found.map.landmark_identity.vector();
  ASSERT_GT(names.size(), 8U) << "the six, and some again";
  for (std::size_t l = kPosts; l < names.size(); ++l) {
    const auto post = static_cast<std::size_t>(names[l] - kPosts);
    EXPECT_NEAR(found.map.landmark_x_m[l], found.map.landmark_x_m[post], 0.2) << names[l];
    EXPECT_NEAR(found.map.landmark_y_m[l], found.map.landmark_y_m[post], 0.2) << names[l];
  }
  const auto rows = found.robot[1].map_landmark;
  const auto name = Read<kinds::Log>(*log).robot[1].observations.landmark;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_GE(rows[i], 0) << i;
    EXPECT_EQ(names[static_cast<std::size_t>(rows[i])], name[i]) << i;
  }
}

TEST(SecondRobots, WithoutRefinementTheNamesThatAreMissingAreSaid) {
  const BlobPtr map = RunInProcess(LandmarkMap({.iterations = 4, .refine = false}),
                                   {{"log", TwoOfWhichTheSecondComesFromElsewhere()}});
  ASSERT_TRUE(map->Has("missing_landmarks"));
  for (const std::int32_t name : map->Get<std::int32_t>("missing_landmarks")) EXPECT_GE(name, kPosts);
}

// What a search of the whole map is taken to move, and what was counted of the third round of all, in which
// both robots start near where they were. The job goes no further.
TEST(Schedule, RobotsThatWereFoundMoveFarFewerCellsThanASearchOfTheWholeMap) {
  struct Enough {};
  std::vector<double> lost(2), found(2);
  const auto look = [&](const proto::Step& plan) {
    const State& state = plan.state();
    if (!state.scalars().contains("robots")) return;  // of a search
    const Schedule schedule = Schedule::Load(state);
    if (schedule.robots < 2) return;
    const RobotStates robots = RobotStates::Load(state, 2);
    if (schedule.settled == 0) lost = robots.work;
    if (schedule.settled < 3) return;
    found = robots.work;
    throw Enough();
  };
  const Blob log = LogOf({{"one", Rounds(1, 1).Make()}, {"other", Rounds(1, 2).Make()}});
  const LandmarkMap pipeline({.starts = 2, .waves = 0});
  EXPECT_THROW(RunInProcess(pipeline, {{"log", std::make_shared<const Blob>(log)}}, look), Enough);
  for (const std::size_t r : {0U, 1U}) {
    EXPECT_GT(found[r], 0.0);
    EXPECT_LT(found[r], 0.1 * lost[r]) << r;
  }
}

FirstRobotTrials RoundTripped(const FirstRobotTrials& trials, cairn::Step* step) {
  trials.Store(step);
  return *FirstRobotTrials::Load(step->plan.state(), 2);
}

// A first robot under which no path fits leaves the map to the other; where none is left the log's first
// says why.
TEST(FirstRobotTrials, OneThatFailsLeavesTheMapToTheOther) {
  Blob log;
  log.Put("robots", Array::Texts({"a", "b"}));
  Blob result;
  result.PutVector<double>("history/log_likelihood", {-9, -7});
  result.PutVector<double>("map/landmark_x_m", {});
  result.Put("search/why", Array::Text("so"));
  const MapInputs inputs;
  cairn::Step step;
  FirstRobotTrials trials({1, 0});
  trials.Failed("no path", log);
  ASSERT_TRUE(trials.Next());
  trials = RoundTripped(trials, &step);
  EXPECT_EQ(trials.robot(), 0U);
  FirstRobotTrials both = trials;
  trials.Ended(result, Settings(), &step);
  EXPECT_FALSE(trials.Next());
  const Blob best = trials.Best(log, inputs, step);
  EXPECT_EQ(best.Scalar<std::int32_t>("search/first_robot"), 0);
  EXPECT_TRUE(std::isnan(best.Get<double>("search/tried_score_nats")[0]));
  EXPECT_EQ(best.Get<double>("search/tried_score_nats")[1], -7);

  both.Failed("no way", log);
  EXPECT_FALSE(both.Next());
  try {
    (void)both.Best(log, inputs, step);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "no way");
  }
}

}  // namespace
}  // namespace cairn::landmark_map
