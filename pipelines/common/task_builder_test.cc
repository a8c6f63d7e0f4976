#include "pipelines/common/task_builder.h"

#include <gtest/gtest.h>

#include <exception>

namespace cairn {
namespace {

proto::Step PlanWithBlob() {
  proto::Step plan;
  (*plan.mutable_state()->mutable_blobs())["map"] = "hash of map";
  return plan;
}

TEST(TaskBuilder, NumbersTasksAndCountsAtLeastAMicrosecond) {
  proto::Step plan;
  EXPECT_EQ(TaskBuilder("a", 0.2, &plan).index(), 0);
  EXPECT_EQ(TaskBuilder("b", 7.9, &plan).index(), 1);
  EXPECT_EQ(plan.tasks(0).cost(), 1u);
  EXPECT_EQ(plan.tasks(1).cost(), 7u);
  EXPECT_EQ(plan.tasks(1).kind(), "b");
}

TEST(TaskBuilder, AParameterKeepsItsType) {
  proto::Step plan;
  const std::string text = "anna";
  TaskBuilder("a", 1, &plan).Set("i", std::size_t{3}).Set("d", 0.5).Set("b", true).Set("s", text);
  const auto& params = plan.tasks(0).params();
  EXPECT_EQ(params.at("i").i(), 3);
  EXPECT_EQ(params.at("d").d(), 0.5);
  EXPECT_TRUE(params.at("b").b());
  EXPECT_EQ(params.at("s").s(), "anna");
}

TEST(TaskBuilder, ReadsBlobsOfTheStateRowsAndPartials) {
  proto::Step plan = PlanWithBlob();
  TaskBuilder("a", 1, &plan)
      .Read("map")
      .Read("here", "map", {2, 3})
      .ReadHash("log", "hash of log")
      .ReadPartial("before", 4);
  const proto::Task& task = plan.tasks(0);
  ASSERT_EQ(task.inputs_size(), 4);
  EXPECT_EQ(task.inputs(0).name(), "map");
  EXPECT_EQ(task.inputs(0).blob(), "hash of map");
  EXPECT_EQ(task.inputs(0).row_count(), 0) << "all";
  EXPECT_EQ(task.inputs(1).name(), "here");
  EXPECT_EQ(task.inputs(1).first_row(), 2);
  EXPECT_EQ(task.inputs(1).row_count(), 3);
  EXPECT_EQ(task.inputs(2).blob(), "hash of log");
  EXPECT_EQ(task.inputs(3).task(), 4u);
  EXPECT_TRUE(task.inputs(3).has_task());
}

TEST(TaskBuilder, WhatTheStateHasNotCannotBeRead) {
  proto::Step plan = PlanWithBlob();
  TaskBuilder task("a", 1, &plan);
  EXPECT_THROW(task.Read("path"), std::exception);
}

}  // namespace
}  // namespace cairn
