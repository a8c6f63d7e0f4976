#include "pipelines/landmark_map/model/work.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/landmark_map/state/schedule.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

struct World {
  explicit World(const Options& options)
      : log(SquareLog{.laps = 6, .side_m = 20.0}.Make()),
        settings(Resolve(options, log)),
        steps(MakeSteps(Read<kinds::Log>(log).robot[0], "rover", settings.steps, nullptr)) {}
  Blob log;
  Settings settings;
  RobotSteps steps;
};

TEST(ReckonOpenLoop, AgreeWithWhatAPassWithoutAMapMovesToAFactorOfTwo) {
  for (const Options& options : {Options{.cell_m = 1.0}, Options{.cell_m = 0.5, .heading_deg = 3.0},
                                 Options{.cell_m = 0.5, .prune = 1e-4}}) {
    const World world(options);
    const EStepModel model = world.settings.Model(nullptr);
    NoProgress progress;
    const Alphas alphas =
        Forward(model, {world.steps, 0, world.steps.size(), "rover"}, DiracStart(model.grid), progress);
    const double expected =
        WorkOf(ReckonOpenLoop(world.steps, model, world.steps.size()).cells, world.steps.size());
    EXPECT_GT(expected, 0.5 * alphas.work) << options.cell_m;
    EXPECT_LT(expected, 2.0 * alphas.work) << options.cell_m;
  }
}

TEST(CellNanoseconds, WiderErrorsAndMoreObservationsCostMore) {
  World world(Options{.cell_m = 1.0});
  const EStepModel model = world.settings.Model(nullptr);
  const double usual = CellNanoseconds(world.steps, model, true);
  EXPECT_GT(CellNanoseconds(world.steps, model, false), usual);
  const World noisy(Options{.cell_m = 1.0, .noise_scale = 5.0});
  EXPECT_GT(CellNanoseconds(noisy.steps, noisy.settings.Model(nullptr), true), usual);
  world.steps.observations.resize(4 * world.steps.observations.size());
  EXPECT_GT(CellNanoseconds(world.steps, model, true), usual);
}

TEST(CellsWhereLost, AreTheTableAndTheWayToTheFirstObservationOnBothSides) {
  World world(Options{.cell_m = 1.0});
  const EStepModel model = world.settings.Model(nullptr);
  int step = 0;
  while (world.steps.first_observation[step + 1] == 0) ++step;
  const double edge = 10.0 + 2.0 * MotionMargin(model, world.steps, step) + 1.0;
  EXPECT_EQ(CellsWhereLost(world.steps, model, 10.0), edge * edge);
  EXPECT_GT(step, 0);
}

TEST(ReckonOpenLoop, NoBoxIsLargerThanTheOneThatIsAllowed) {
  const World wide(Options{.cell_m = 0.5}), narrow(Options{.cell_m = 0.5, .box_m = 2.0});
  const auto all = ReckonOpenLoop(wide.steps, wide.settings.Model(nullptr), wide.steps.size()).cells;
  const auto cut = ReckonOpenLoop(narrow.steps, narrow.settings.Model(nullptr), narrow.steps.size()).cells;
  EXPECT_LT(cut.back(), 0.5 * all.back());
}

TEST(ReckonOpenLoop, WholeTablesHoldAllThatIsAllowedUnderEveryHeading) {
  const World world(Options{.cell_m = 1.0, .tables = "whole", .box_m = 60.0});
  const EStepModel model = world.settings.Model(nullptr);
  const auto cells = ReckonOpenLoop(world.steps, model, world.steps.size()).cells;
  EXPECT_EQ(cells.front(), 61.0 * 61.0 * model.grid.headings);
  EXPECT_EQ(cells.back(), cells.front());
}

// With odometry that does not err a belief is one heading's, as wide as the shift's blur and its margin: of
// one motion increment, and of two where the robot saw nothing in between.
TEST(MeanCellsInAMap, IsWhatIncrementsFromWhereTheRobotSawSomethingAddUpTo) {
  RobotSteps steps;
  steps.odo_x_m = {0.0, 10.0, 20.0, 30.0};
  steps.odo_y_m = steps.odo_heading_rad = steps.turn_rad = steps.time_s = {0.0, 0.0, 0.0, 0.0};
  steps.path_m = {0.0, 10.0, 10.0, 10.0};
  steps.first_observation = {0, 0, 1, 1, 2};  // at the second and the last
  World world(Options{.cell_m = 1.0});
  world.settings.noise = {};
  world.settings.prune = std::exp(-0.5 * 3.0 * 3.0);  // three standard deviations
  const auto cells = [](int increments) {
    return std::pow(2.0 * 3.0 * std::sqrt(increments / 6.0) + 4.0, 2.0);
  };
  EXPECT_NEAR(MeanCellsInAMap(steps, world.settings.Model(nullptr)),
              (cells(0) + cells(1) + cells(1) + cells(2)) / 4.0, 1e-9);
}

// Of a way with a landmark of its own at each step: those of the second half are seen for the first time, so
// the belief spreads from its first step on, by as much as without a map.
TEST(WorkInAMapUpTo, BeliefsSpreadWhereLandmarksAreSeenForTheFirstTime) {
  constexpr int kSteps = 8;
  RobotSteps steps;
  for (int s = 0; s < kSteps; ++s) {
    steps.odo_x_m.push_back(10.0 * s);
    steps.path_m.push_back(s == 0 ? 0.0 : 10.0);
    steps.first_observation.push_back(s);
    steps.observations.push_back({s, 1.0, 0.0});
  }
  steps.first_observation.push_back(kSteps);
  steps.odo_y_m = steps.odo_heading_rad = steps.turn_rad = steps.time_s = std::vector<double>(kSteps, 0.0);
  const World world(Options{.cell_m = 1.0});
  const EStepModel model = world.settings.Model(nullptr);
  const std::vector<double> open = ReckonOpenLoop(steps, model, kSteps).cells;
  const double known = WorkInAMapUpTo(kSteps, kSteps, 0.0, steps, model);
  EXPECT_NEAR(known, open[0] + (kSteps - 1) * open[1] + kSteps * kStepCells, 1e-6 * known);
  const double half = WorkInAMapUpTo(kSteps / 2, kSteps, 0.0, steps, model);
  EXPECT_NEAR(half - known, open[2] + open[3] + open[4] - 3.0 * open[1], 1e-6 * known);
  EXPECT_EQ(WorkInAMapUpTo(1, kSteps, 1e9, steps, model), 1e9 * kSteps) << "at least";
}

TEST(ForwardFor, StopsWhereItsWorkIsDoneAndGivesTheSameAlpha) {
  const World world(Options{.cell_m = 0.5});
  const EStepModel model = world.settings.Model(nullptr);
  const Slice all{world.steps, 0, world.steps.size(), "rover"};
  NoProgress progress;
  const LayeredGrid start = DiracStart(model.grid);
  const Alphas alphas = Forward(model, all, start, progress);
  const Frontier one = ForwardFor(model, all, start, 1.0, progress);
  EXPECT_EQ(one.end, 1) << "a step at least";
  const Frontier half = ForwardFor(model, all, start, 0.5 * alphas.work, progress);
  EXPECT_GT(half.end, 1);
  EXPECT_LT(half.end, world.steps.size());
  const LayeredGrid& table = alphas.tables[static_cast<std::size_t>(half.end - 1)];
  for (std::size_t c = 0; c < table.layers.size(); ++c) {
    EXPECT_EQ(half.alpha.layers[c].box, table.layers[c].box);
    EXPECT_EQ(half.alpha.layers[c].values, table.layers[c].values);
  }
  EXPECT_EQ(ForwardFor(model, all, start, 1e300, progress).end, world.steps.size())
      << "no further than the end";
}

TEST(SlicesFor, OneWhereTheWorkFitsElseMoreThanShouldBeNeededButNoMoreThanSteps) {
  EXPECT_EQ(SlicesFor(100.0, 100.0, 50), 1);
  EXPECT_EQ(SlicesFor(1000.0, 100.0, 50), 17);
  EXPECT_EQ(SlicesFor(1e9, 100.0, 50), 50);
  EXPECT_EQ(SlicesFor(1e9, 100.0, 1), 1);
}

// Out 20 m and back again: it comes back to its first observation where the belief, which the way has made
// wide, holds that place, and not while it still stands there.
TEST(FirstReturn, IsWhereTheBeliefHoldsAPlaceAgainThatItHadLeft) {
  RobotSteps steps;
  for (int s = 0; s <= 40; ++s) {
    steps.time_s.push_back(s);
    steps.odo_x_m.push_back(s <= 20 ? s : 40 - s);
    steps.odo_y_m.push_back(0.0);
    steps.odo_heading_rad.push_back(0.0);
    steps.path_m.push_back(s == 0 ? 0.0 : 1.0);
    steps.turn_rad.push_back(0.0);
    const bool observes = s == 1 || s == 20 || s >= 30;
    steps.first_observation.push_back(static_cast<std::int32_t>(steps.observations.size()));
    if (observes) steps.observations.push_back({});
  }
  steps.first_observation.push_back(static_cast<std::int32_t>(steps.observations.size()));
  EStepModel model;
  model.grid.cell_m = 1.0;
  OpenLoop loop;
  for (int s = 0; s <= 40; ++s) {
    const int x = static_cast<int>(steps.odo_x_m[static_cast<std::size_t>(s)]), half = s / 10;
    loop.boxes.push_back(Box{x, 0, 1, 1}.Grown(half));
  }
  EXPECT_EQ(FirstReturn(steps, loop, model), 36)
      << "4 m from where it was at 1 m, with a box of 3 m to each side";
  loop.boxes.resize(30);
  EXPECT_EQ(FirstReturn(steps, loop, model), steps.size()) << "it never does";
}

}  // namespace
}  // namespace cairn::landmark_map
