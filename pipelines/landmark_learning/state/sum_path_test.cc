#include "pipelines/landmark_learning/state/sum_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "schema/error.h"
#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

// Along a line that is askew, `off_m` to its sides.
Positions Corridor(int count, double off_m) {
  Positions positions;
  for (int k = 0; k < count; ++k) {
    const double t = 89.0 * k / count,
                 across = off_m * std::sin(1.7 * k) * std::sin(3.14159 * k / (count - 1));
    positions.x_m.push_back(10.0 + 0.6 * t - 0.8 * across);
    positions.y_m.push_back(-3.0 + 0.8 * t + 0.6 * across);
    positions.along_m.push_back(t);
  }
  return positions;
}

std::string Text(const Options& options, const Positions& positions) {
  return PlanSum(options, positions).text;
}

TEST(PlanSum, TakesTheCheapestThatKeepsItsBound) {
  const Positions line = Corridor(6000, 0.0), near_line = Corridor(6000, 0.2), few = Corridor(40, 0.0);
  EXPECT_EQ(PlanSum({.window_m = 0.0}, line).path, SumPath::kLine);
  EXPECT_EQ(PlanSum({.window_m = 10.0}, line).path, SumPath::kLine);
  EXPECT_EQ(PlanSum({.window_m = 0.0}, few).path, SumPath::kPairs);
  EXPECT_EQ(PlanSum({.window_m = 0.0}, near_line).path, SumPath::kTree);
  EXPECT_EQ(PlanSum({.window_m = 10.0}, near_line).path, SumPath::kPairs);
  EXPECT_EQ(PlanSum({.window_m = 0.0, .error = "along"}, near_line).path, SumPath::kLine);
  EXPECT_EQ(PlanSum({.window_m = 0.0, .error = "squared"}, near_line).path, SumPath::kLine);
  EXPECT_EQ(PlanSum({.window_m = 10.0, .error = "along"}, line).path, SumPath::kPairs);
  EXPECT_EQ(PlanSum({.window_m = 10.0, .belief = "gaussian"}, line).path, SumPath::kPairs);
}

TEST(PlanSum, SaysWhatItMayBeOffBy) {
  const Positions line = Corridor(6000, 0.0), near_line = Corridor(6000, 0.2);
  EXPECT_EQ(Text({.sum = "pairs"}, line), "sum over all pairs in reach");
  EXPECT_EQ(Text({.window_m = 0.0}, line), "sum along the line, relative error below 2.7e-12");
  EXPECT_EQ(Text({.window_m = 0.0}, near_line),
            "sum by a tree, each distance and E off by at most 1e-05 of itself");
  EXPECT_EQ(Text({.sum = "line"}, near_line), "sum along the line, distances up to 0.4 m short");
}

// On the line that a job forces, each position is where it was along it.
TEST(PlanSum, ProjectsPositionsOntoTheLine) {
  const Positions corridor = Corridor(300, 0.2);
  const SumPlan plan = PlanSum({.sum = "line"}, corridor);
  const Positions& positions = plan.PositionsOf(corridor);
  for (std::size_t k = 0; k < 300; ++k) {
    EXPECT_NEAR(positions.x_m[k], 89.0 * static_cast<double>(k) / 300.0, 0.01);
    EXPECT_EQ(positions.y_m[k], 0.0);
  }
}

std::string SumPathComplaint(const Options& options) {
  try {
    PlanSum(options, Corridor(10, 0.1));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PlanSum, BeliefsThatLookAtHeadingsAreSummedOverPairs) {
  for (const double off_m : {0.0, 0.2}) {
    Positions positions = Corridor(6000, off_m);
    positions.cos_heading.assign(6000, 1.0);
    positions.sin_heading.assign(6000, 0.0);
    EXPECT_EQ(PlanSum({.window_m = 0.0, .heading_window_deg = 90.0}, positions).path, SumPath::kPairs);
  }
}

TEST(PlanSum, RefusesToBeForcedWhereItCannot) {
  EXPECT_EQ(SumPathComplaint({.window_m = 0.0, .sum = "tree"}), "");
  EXPECT_EQ(SumPathComplaint({.window_m = 2.0, .sum = "tree"}),
            "sum = tree: it takes distances, and window_m = 0: nothing known before");
  EXPECT_EQ(
      SumPathComplaint({.belief = "gaussian", .sum = "line"}),
      "sum = line: it takes a uniform belief in samples that face whichever way, and distances, and errors "
      "along the path only where nothing is known before");
}

TEST(PlanSum, EachPathMayBeAskedFor) {
  const std::pair<const char*, SumPath> paths[] = {
      {"pairs", SumPath::kPairs}, {"line", SumPath::kLine}, {"tree", SumPath::kTree}};
  for (const auto& [name, path] : paths) {
    OptionValues values;
    values["sum"].set_s(name);
    Options options = ParseOptions<Options>(values);
    options.window_m = 0.0;
    EXPECT_EQ(PlanSum(options, Corridor(10, 0.0)).path, path) << name;
  }
}

}  // namespace
}  // namespace cairn::landmark_learning
