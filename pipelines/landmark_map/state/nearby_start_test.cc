#include "pipelines/landmark_map/state/nearby_start.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pipelines/testing/in_process.h"
#include "schema/blob.h"

namespace cairn::landmark_map {
namespace {

constexpr int kAround = 36;  // headings: fifteen degrees are two

MapRules RulesOfNearbyStart() {
  MapRules rules;
  rules.grid = {0.5, kAround};
  rules.radius_m = 1.2;  // three cells
  return rules;
}

TEST(SupportOf, HoldsWhatIsLikelierThanAMillionthOfTheLikeliest) {
  LayeredGrid belief;
  belief.layers.assign(3, Layer());
  belief.layers[1] = Layer(Box{0, 0, 9, 9});
  belief.layers[1].Row(2)[3] = 1.0;
  belief.layers[1].Row(4)[5] = 2e-6;
  belief.layers[1].Row(8)[8] = 0.5e-6;
  belief.layers[2] = Layer(Box{0, 0, 2, 2});
  belief.layers[2].Row(0)[0] = 1e-7;
  const std::vector<StartBox> start = SupportOf(belief, 4);
  ASSERT_EQ(start.size(), 1U);
  EXPECT_EQ(start[0].robot, 4);
  EXPECT_EQ(start[0].heading, 1);
  EXPECT_EQ(start[0].box(), (Box{3, 2, 3, 3}));
}

TEST(Nearby, IsAroundTheStartAndRoundTheCircleAndNeverBeyondAnywhere) {
  std::vector<Box> anywhere(kAround, Box{-100, -100, 200, 200});
  anywhere[1] = Box{0, 0, 5, 5};
  const std::vector<Box> near = Nearby(anywhere, {{0, 0, 10, 20, 4, 6}}, RulesOfNearbyStart());
  ASSERT_EQ(near.size(), anywhere.size());
  const Box grown = Box{10, 20, 4, 6}.Grown(13);
  for (const int c : {34, 35, 0, 2}) EXPECT_EQ(near[c], grown) << c;
  EXPECT_EQ(near[1], Intersection(grown, anywhere[1]));
  for (int c = 3; c < 34; ++c) EXPECT_TRUE(near[c].empty()) << c;
  EXPECT_EQ(Nearby(anywhere, {{0, 9, 150, 0, 1, 1}}, RulesOfNearbyStart()), anywhere) << "nothing is left";
}

TEST(CheckStart, RefusesWhatNoTaskReturns) {
  CheckStart({{1, 35, -5, 7, 1, 1}}, 2, kAround);
  for (const StartBox& wrong :
       {StartBox{2, 0, 0, 0, 1, 1}, StartBox{0, 36, 0, 0, 1, 1}, StartBox{0, -1, 0, 0, 1, 1},
        StartBox{0, 0, 1 << 30, 0, 1, 1}, StartBox{0, 0, 0, 0, 0, 1}})
    EXPECT_THROW(CheckStart({wrong}, 2, kAround), InputError);
}

// Three landmarks that look alike, no two of them as far apart as any others; a robot that sees them one
// after the other.
struct ThreePosts {
  Perception perception;
  RobotSteps steps;
  EStepModel model;

  ThreePosts() {
    constexpr std::array<std::array<int, 2>, 3> kPosts{{{0, 0}, {14, 3}, {5, 22}}};
    Layer seen(Box{-20, -20, 60, 60});
    for (int y = -20; y < 40; ++y) {
      for (int x = -20; x < 40; ++x) {
        seen.Row(y)[x] = 1e-4;
        for (const auto& [px, py] : kPosts)
          seen.Row(y)[x] += std::exp(-0.5 * ((x - px) * (x - px) + (y - py) * (y - py)));
      }
    }
    perception.likelihood.layers = {seen};
    perception.outside = {1e-4};
    steps.time_s = {0, 1, 2, 3};
    steps.odo_x_m = {0, 2, 4, 6};
    steps.odo_y_m = {0, 0, 0, 0};
    steps.odo_heading_rad = {0, 0, 0, 0};
    steps.path_m = {0, 2, 2, 2};
    steps.turn_rad = {0, 0, 0, 0};
    steps.first_observation = {0, 1, 2, 3, 4};
    const std::array<std::array<double, 2>, 4> seen_at{{{-3, -2}, {2, -0.5}, {-4.5, 9}, {-9, -2}}};
    for (std::size_t k = 0; k < seen_at.size(); ++k)
      steps.observations.push_back({0, seen_at[k][0], seen_at[k][1]});
    model.grid = {0.5, kAround};
    model.noise = {0.0, 0.03, 1.0, 0.02, 0.02};
    model.prune = 1e-4;
    model.perception = &perception;
  }
  ThreePosts(const ThreePosts&) = delete;
  ThreePosts& operator=(const ThreePosts&) = delete;
};

// Near where it was found the robot is found again: the same belief and the same likelihood, if the places
// count that were left out.
TEST(Nearby, FindsWhatAStartAnywhereFindsAndMovesFarFewerCells) {
  const ThreePosts world;
  NoProgress progress;
  const Slice slice{world.steps, 0, 4, "a"};
  const auto found = [&](const LayeredGrid& start, LayeredGrid* first) {
    Alphas alphas = Forward(world.model, slice, start, progress);
    Backward(world.model, slice, alphas, start, UniformBeta(alphas.tables.back()), progress,
             Visitor{[&](int step, const LayeredGrid& belief) {
                       if (step == 0) *first = belief;
                     },
                     nullptr});
    return alphas;
  };
  const std::vector<Box> anywhere = StartBoxes(world.model, slice);
  const LayeredGrid wide = UniformOver(anywhere);
  LayeredGrid first, again;
  const Alphas lost = found(wide, &first);
  const LayeredGrid start = UniformOver(Nearby(anywhere, SupportOf(first, 0), RulesOfNearbyStart()));
  ASSERT_LT(start.cells(), wide.cells());
  const Alphas near = found(start, &again);
  EXPECT_LT(near.work - 4 * kStepCells, 0.5 * (lost.work - 4 * kStepCells));
  const double places = static_cast<double>(start.cells()) / static_cast<double>(wide.cells());
  EXPECT_NEAR(near.log_likelihood + std::log(places), lost.log_likelihood, 0.05)
      << "selective computation cuts off other tails";
  double apart = 0.0;
  for (std::size_t c = 0; c < first.layers.size(); ++c) {
    Layer difference = first.layers[c];
    difference.Cover(again.layers[c].box);
    if (!again.layers[c].box.empty()) difference.AddShifted(again.layers[c], 0, 0, -1.0);
    for (const double value : difference.values) apart += std::abs(value);
  }
  EXPECT_LT(apart, 0.05);
}

}  // namespace
}  // namespace cairn::landmark_map
