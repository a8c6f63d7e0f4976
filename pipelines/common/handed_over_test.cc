#include "pipelines/common/handed_over.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "schema/error.h"

namespace cairn {
namespace {

TEST(HandedOver, WhatIsWithinPassesAndNothingElseDoes) {
  EXPECT_NO_THROW(RequireWithin("n", std::int64_t{3}, 3, 3));
  EXPECT_THROW(RequireWithin("n", std::int64_t{2}, 3, 4), InputError);
  EXPECT_THROW(RequireWithin("n", std::numeric_limits<std::int64_t>::max(), 3, 4), InputError);
  EXPECT_NO_THROW(RequireWithin("x", 0.5, 0.0, 1.0));
  for (const double x : {std::nan(""), std::numeric_limits<double>::infinity(), -1e-300})
    EXPECT_THROW(RequireWithin("x", x, 0.0, 1.0), InputError) << x;
  EXPECT_THROW(RequireAllWithin("x", std::vector<float>{0, 1, NAN}, 0.0, 1.0), InputError);
  EXPECT_THROW(RequireSize("x", 2, 3), InputError);
}

TEST(HandedOver, AGridIsOneThatCanBeCounted) {
  EXPECT_NO_THROW(RequireGrid({-1, 2, 0.5, 5, 4}, 20));
  constexpr std::int64_t kMany = std::int64_t{1} << 62;
  for (const GridBox& grid : {GridBox{-1, 2, 0.5, 5, 5},
                              {-1, 2, 0.5, 0, 4},
                              {-1, 2, 0.5, 5, -4},
                              {-1, 2, 0.5, kMany, kMany},
                              {-1, 2, 0, 5, 4},
                              {std::nan(""), 2, 0.5, 5, 4}})
    EXPECT_THROW(RequireGrid(grid, 20), InputError) << grid.columns << " by " << grid.rows;
}

TEST(HandedOver, ATaskIsOfAKindThatItsPipelineHas) {
  proto::Task task;
  task.set_kind("walls");
  EXPECT_NO_THROW(RequireKind(task, {"pairs", "walls"}));
  task.set_kind("wallsWALLS");
  EXPECT_THROW(RequireKind(task, {"pairs", "walls"}), InputError);
}

TEST(HandedOver, AParameterIsThereAndWithinItsBounds) {
  proto::Task task;
  (*task.mutable_params())["own"].set_i(7);
  (*task.mutable_params())["share"].set_d(0.5);
  EXPECT_EQ(IntegerOf(task, "own", 0, 7), 7);
  EXPECT_THROW(IntegerOf(task, "own", 0, 6), InputError);
  EXPECT_THROW(IntegerOf(task, "first", 0, 6), InputError);
  EXPECT_THROW(IntegerOf(task, "share", 1, 6), InputError);  // of another kind: 0
}

}  // namespace
}  // namespace cairn
