#include "pipelines/landmark_map/estimate.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_map {
namespace {

// All of it is reckoned from sizes, the seconds, too, and held against sizes: nothing here reads a clock.
std::map<std::string, double> Expected(const Options& options) {
  const auto log = std::make_shared<const Blob>(SquareLog{.laps = 6, .side_m = 20.0}.Make());
  const Step step = LandmarkMap(options).Start(MapInputs({{"log", log}}));
  std::map<std::string, double> expected;
  for (const auto& [name, value] : step.plan.state().scalars()) {
    if (name.starts_with("expected/")) expected[name.substr(9)] = value.d();
  }
  return expected;
}

TEST(Estimate, IsInTheFirstStateWithEveryFigureAboveZero) {
  const auto expected = Expected({.cell_m = 1.0});
  for (const char* name : {"cells", "tasks", "rounds", "seconds", "task_mb", "memory_mb", "store_mb"}) {
    ASSERT_TRUE(expected.contains(name)) << name;
    EXPECT_GT(expected.at(name), 0.0) << name;
  }
  EXPECT_GT(expected.at("memory_mb"), expected.at("task_mb"));
}

TEST(Estimate, AFinerGridCostsMoreOfEverything) {
  const auto coarse = Expected({.cell_m = 1.0}), fine = Expected({.cell_m = 0.25});
  for (const char* name : {"cells", "seconds", "task_mb", "memory_mb", "store_mb"}) {
    EXPECT_GT(fine.at(name), coarse.at(name)) << name;
  }
}

TEST(Estimate, CountsEveryStartAndWhatComesAfterThem) {
  const auto seconds = [](Options options) { return Expected(options).at("seconds"); };
  const double one = seconds({.starts = 1}), ten = seconds({.starts = 10, .waves = 0});
  EXPECT_GT(ten, 5.0 * one) << "each but for the rounds at the end, some with less data at first";
  EXPECT_LT(ten, 10.0 * one);
  EXPECT_GT(seconds({.starts = 10}), 1.5 * ten);
}

// One pass forward makes a map of each observation and goes on in it: less than the same steps without any
// map, forward and backward, which was its plan.
TEST(Estimate, OnePassHasAPlanOfItsOwn) {
  const auto pass = Expected({.cell_m = 1.0, .incremental = true});
  const auto no_map = Expected({.cell_m = 1.0, .iterations = 0, .starts = 1});
  EXPECT_LT(pass.at("seconds"), 0.7 * no_map.at("seconds"));
  EXPECT_LT(pass.at("task_mb"), 0.7 * no_map.at("task_mb"));
  EXPECT_EQ(pass.at("rounds"), 1.0);
}

// Five robots of four controls each, which turn by 0.3 rad a control and see a landmark of their own at a
// distance: once the others join, the first one's start is as unknown as theirs.
BlobPtr LogOfLooseRobots() {
  constexpr int kRobots = 5;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Blob log;
  std::vector<std::string> robots, landmarks;
  for (int r = 0; r < kRobots; ++r) {
    robots.push_back("r" + std::to_string(r));
    landmarks.push_back(std::to_string(r));
    Blob robot;
    robot.PutVector<double>("odometry/time_s", {0, 1, 2, 3});
    robot.PutVector<double>("odometry/turn_rad", std::vector<double>(4, 0.3));
    robot.PutVector<double>("odometry/forward_m", std::vector<double>(4, 1.0));
    robot.PutVector<double>("observations/time_s", {2, 3});
    robot.PutVector<std::int32_t>("observations/landmark", {r, -1});
    robot.PutVector<double>("observations/range_m", {1, nan});
    robot.PutVector<double>("observations/bearing_rad", {0, nan});
    log.PutAll("robot/" + std::to_string(r) + "/", robot);
  }
  log.Put("robots", Array::Texts(robots));
  log.Put("landmarks", Array::Texts(landmarks));
  return std::make_shared<const Blob>(std::move(log));
}

// What the tasks of one round of all robots cost by the cells that the round before moved, so that it was
// counted and not foreseen: of the third, before which the first robot's start is no more anywhere. The job
// goes no further.
double WorkOfARoundOfAll(const Options& options, const BlobPtr& log) {
  struct Enough {
    double seconds;
  };
  int rounds = 0;
  const auto look = [&](const proto::Step& plan) {
    double microseconds = 0;
    bool of_all = false;
    for (const Task& task : plan.tasks()) {
      microseconds += static_cast<double>(task.cost());
      const auto joint = task.params().find("joint");
      of_all |= joint != task.params().end() && joint->second.b();
    }
    rounds += of_all ? 1 : 0;
    if (rounds == 3) throw Enough{1e-6 * microseconds};
  };
  try {
    RunInProcess(LandmarkMap(options), {{"log", log}}, look);
  } catch (const Enough& enough) {
    return enough.seconds;
  }
  ADD_FAILURE() << "there are no three rounds of all robots";
  return 0;
}

double ExpectedSeconds(const Options& options, const BlobPtr& log) {
  const Step step = LandmarkMap(options).Start(MapInputs({{"log", log}}));
  return step.plan.state().scalars().at("expected/seconds").d();
}

TEST(Estimate, CountsTheFirstRobotWhoseFrameIsLoose) {
  const BlobPtr log = LogOfLooseRobots();
  const Options options{.heading_deg = 4.0};
  const double rounds = 1.0 + static_cast<double>(options.iterations);
  const double work = rounds * WorkOfARoundOfAll(options, log);
  EXPECT_GT(ExpectedSeconds(options, log), work / 3.0);
  EXPECT_LT(ExpectedSeconds(options, log), work * 3.0);
}

// Two robots without names, whose map is searched on a coarser grid than the one on which they join.
TEST(Estimate, OfTwoRobotsWithoutNamesIsRightToAFactorOfTwo) {
  const auto robot = [](std::uint64_t seed) {
    return PostsLog{.drift_rad_per_m = 0.002, .seed = seed, .times = 1}.Make();
  };
  Blob two = robot(1);
  two.PutAll("robot/1/", robot(2).Sub("robot/0/"));
  two.Put("robots", Array::Texts({"one", "other"}));
  const BlobPtr log = std::make_shared<const Blob>(std::move(two));
  const Options options{.starts = 2, .waves = 0};
  double work = 0;
  RunInProcess(LandmarkMap(options), {{"log", log}}, [&](const proto::Step& plan) {
    for (const Task& task : plan.tasks()) work += 1e-6 * static_cast<double>(task.cost());
  });
  EXPECT_GT(ExpectedSeconds(options, log), work / 2.0);
  EXPECT_LT(ExpectedSeconds(options, log), work * 2.0);
}

// Two observations do not find a robot: EM goes on for as long as it may, each round as long as the others.
TEST(Estimate, CountsAllRoundsWhereLittleWasSeen) {
  const BlobPtr log = LogOfLooseRobots();
  const double ten = ExpectedSeconds({.iterations = 10}, log);
  EXPECT_GT(ExpectedSeconds({.iterations = 21}, log), 1.8 * ten);
}

// A chain of one slice hands nothing over, and what a round of a moment returns is not saved.
TEST(Estimate, TheStoreHoldsWhatIsSavedOnly) {
  const auto whole = Expected({.cell_m = 1.0, .iterations = 0, .starts = 1});
  const auto cut = Expected({.cell_m = 0.1, .heading_deg = 2.0, .iterations = 0, .starts = 1});
  EXPECT_LT(whole.at("store_mb"), 1.0);
  EXPECT_GT(cut.at("store_mb"), 20.0 * whole.at("store_mb"));
}

TEST(Estimate, AnOnlyRoundIsOverAllSteps) {
  const auto whole = Expected({.cell_m = 1.0, .iterations = 0, .growth_start = 1.0});
  const auto grown = Expected({.cell_m = 1.0, .iterations = 0, .growth_start = 0.05});
  EXPECT_EQ(grown, whole) << "the share of the first iteration is that of an iteration";
  EXPECT_EQ(whole.at("rounds"), 1.0);
}

TEST(Estimate, ATaskOverWhatIsAllowedIsRefusedAtTheStartWithBothFigures) {
  const double needed = Expected({.cell_m = 0.25}).at("task_mb");
  try {
    Expected({.cell_m = 0.25, .memory_mb = 0.9 * needed});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("would need about"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("memory_mb = "), std::string::npos) << e.what();
  }
}

TEST(MStepBytes, CountsTheUnknownLayerWithThePerceptualRadiusAroundIt) {
  MapRules rules;
  rules.grid.cell_m = 1.0;
  rules.radius_m = 10.0;
  rules.types = 1;
  LayeredGrid counts;
  counts.layers.resize(2);
  EXPECT_EQ(MStepBytes(counts, rules), 0.0);
  counts.layers[0].Cover({0, 0, 10, 10});
  EXPECT_DOUBLE_EQ(MStepBytes(counts, rules), 9.0 * 8.0 * 100.0);
  counts.layers[1].Cover({0, 0, 10, 10});
  EXPECT_DOUBLE_EQ(MStepBytes(counts, rules), 9.0 * 8.0 * (100.0 + 900.0));
}

}  // namespace
}  // namespace cairn::landmark_map
