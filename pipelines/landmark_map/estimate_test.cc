#include "pipelines/landmark_map/estimate.h"

#include <gtest/gtest.h>

#include <memory>

#include "pipelines/in_process.h"
#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

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
