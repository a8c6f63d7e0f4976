#include "worker/task_queue.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>

#include "pipelines/pipeline.h"

namespace cairn::worker {
namespace {

wire::NamedBlob InputOf(int value) {
  Blob blob;
  blob.PutScalar<std::int32_t>("v", value);
  return wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
}

wire::Assign RunOf(std::uint32_t index, const std::vector<wire::NamedBlob>& inputs) {
  wire::Assign assign;
  assign.mutable_key()->set_job("j");
  assign.mutable_key()->set_task(index);
  for (const wire::NamedBlob& input : inputs)
    assign.mutable_task()->add_inputs()->set_blob(input.hash.Binary());
  return assign;
}

wire::Assign AdvanceOf(const std::vector<wire::NamedBlob>& partials) {
  wire::Assign assign;
  assign.mutable_key()->set_job("j");
  assign.mutable_key()->set_kind(wire::TaskKey::ADVANCE);
  for (const wire::NamedBlob& partial : partials) assign.add_partials(partial.hash.Binary());
  return assign;
}

class TaskQueueTest : public ::testing::Test {
 protected:
  std::vector<Want> TakeWants() {
    std::vector<Want> wants;
    while (const std::optional<Want> want = queue_.TakeWant()) wants.push_back(*want);
    return wants;
  }
  int woken_ = 0;
  TaskQueue queue_{[this] { ++woken_; }};
};

TEST_F(TaskQueueTest, ABlobThatTwoTasksNeedIsWantedOnceAndReachesBoth) {
  const wire::NamedBlob a = InputOf(1);
  const wire::NamedBlob b = InputOf(2);
  queue_.Add(RunOf(0, {a, a}));
  queue_.Add(RunOf(1, {b, a}));
  std::vector<Want> wants = TakeWants();
  ASSERT_EQ(wants.size(), 2u);
  EXPECT_TRUE(TakeWants().empty());
  queue_.Deliver(a);
  queue_.Deliver(b);
  for (const std::uint32_t index : {0u, 1u}) {
    const TaskPtr task = queue_.Next();
    EXPECT_EQ(task->assign.key().task(), index);
    EXPECT_EQ(task->blobs.at(a.hash), a.blob);
    EXPECT_EQ(task->ticks, index + 1);  // an input that comes counts as progress
    queue_.Finish(*task, {});
  }
  EXPECT_EQ(queue_.TakeAnswers().size(), 2u);
  EXPECT_EQ(woken_, 2);
}

TEST_F(TaskQueueTest, ACancelledTaskNeverComesUpAndARunningOneGivesNoAnswer) {
  queue_.Add(RunOf(0, {}));
  queue_.Add(RunOf(1, {}));
  queue_.Add(RunOf(2, {}));
  const TaskPtr running = queue_.Next();
  queue_.Cancel(RunOf(0, {}).key());
  queue_.Cancel(RunOf(1, {}).key());
  EXPECT_TRUE(running->cancelled);
  EXPECT_EQ(queue_.Assigned().tasks_size(), 1);
  queue_.Finish(*running, {});
  EXPECT_EQ(queue_.Next()->assign.key().task(), 2u);
  EXPECT_TRUE(queue_.TakeAnswers().empty());
}

TEST_F(TaskQueueTest, OfWhatWasCancelledOrHasFailedNothingStays) {
  const wire::NamedBlob shared = InputOf(0);
  queue_.Add(RunOf(0, {shared}));
  for (int i = 1; i < 100; ++i) {
    queue_.Add(RunOf(1, {shared, InputOf(i)}));
    queue_.Cancel(RunOf(1, {}).key());
  }
  EXPECT_EQ(queue_.Count(), 1u);
  const std::vector<Want> wants = TakeWants();
  ASSERT_EQ(wants.size(), 1u) << "of the task that is still there";
  EXPECT_EQ(wants[0].hash, shared.hash);
  queue_.Deliver(shared);
  const TaskPtr first = queue_.Next();
  EXPECT_EQ(first->blobs.size(), 1u);
  queue_.Finish(*first, {});
  EXPECT_EQ(queue_.Count(), 1u) << "its answer";
  EXPECT_EQ(queue_.TakeAnswers().size(), 1u);

  queue_.Add(AdvanceOf({InputOf(1), InputOf(2)}));
  TaskPtr unread = queue_.Next();
  EXPECT_EQ(unread.use_count(), 4) << "this one, the queue's, and one for each of the partials";
  queue_.Finish(*unread, {});
  EXPECT_EQ(unread.use_count(), 1);
  EXPECT_TRUE(TakeWants().empty());
}

TEST_F(TaskQueueTest, AnotherAttemptAtTheSameTaskIsNotCancelled) {
  queue_.Add(RunOf(0, {}));
  wire::TaskKey other = RunOf(0, {}).key();
  other.set_attempt(7);
  queue_.Cancel(other);
  EXPECT_EQ(queue_.Assigned().tasks_size(), 1);
}

TEST_F(TaskQueueTest, WhatTheCoordinatorLacksIsAFailureOfTheTasksThatNeedIt) {
  const wire::NamedBlob a = InputOf(1);
  queue_.Add(RunOf(0, {a}));
  queue_.Add(RunOf(1, {}));
  queue_.GiveUp(a.hash);
  const TaskPtr first = queue_.Next();
  EXPECT_NE(queue_.FailureOf(*first).find(a.hash.Hex()), std::string::npos);
  queue_.Finish(*first, {});
  EXPECT_TRUE(queue_.FailureOf(*queue_.Next()).empty());
}

TEST_F(TaskQueueTest, AHashOfTheWrongLengthIsAFailureNotACrash) {
  wire::Assign assign = RunOf(0, {});
  assign.mutable_task()->add_inputs()->set_blob("short");
  queue_.Add(assign);
  EXPECT_NE(queue_.FailureOf(*queue_.Next()).find("malformed"), std::string::npos);
}

TEST_F(TaskQueueTest, PartialsAreFetchedAFewAheadOfTheReader) {
  std::vector<wire::NamedBlob> partials(100);
  for (int i = 0; i < 100; ++i) partials[i] = InputOf(i % 40);  // equal partials are common
  queue_.Add(AdvanceOf(partials));
  const TaskPtr task = queue_.Next();
  std::size_t wanted = 0;
  for (std::size_t i = 0; i < partials.size(); ++i) {
    for (const Want& want : TakeWants()) {
      EXPECT_FALSE(want.keep);
      ++wanted;
      queue_.Deliver(InputOf(static_cast<int>(wanted - 1) % 40));
    }
    EXPECT_EQ(queue_.AwaitPartial(*task, i)->Scalar<std::int32_t>("v"), static_cast<int>(i) % 40);
    EXPECT_LT(wanted, i + 20);
  }
  EXPECT_GE(wanted, 40u);
}

TEST_F(TaskQueueTest, AReaderThatWaitsForAPartialIsFreedByACancel) {
  const wire::NamedBlob a = InputOf(1);
  queue_.Add(AdvanceOf({a}));
  const TaskPtr task = queue_.Next();
  std::thread talker([&] { queue_.Cancel(task->assign.key()); });
  EXPECT_THROW(queue_.AwaitPartial(*task, 0), Cancelled);
  talker.join();
}

TEST_F(TaskQueueTest, WhatStillComputesWhenItWasCalledBackIsTold) {
  queue_.Add(RunOf(0, {}));
  EXPECT_FALSE(queue_.Assigned().stuck());
  const TaskPtr task = queue_.Next();
  EXPECT_FALSE(queue_.Assigned().stuck());
  queue_.Cancel(task->assign.key());
  EXPECT_TRUE(queue_.Assigned().stuck());
  EXPECT_EQ(queue_.Assigned().tasks_size(), 0);
  queue_.Finish(*task, {});
  EXPECT_FALSE(queue_.Assigned().stuck());
}

TEST_F(TaskQueueTest, DroppingAllForgetsAnswersTooAndClosingEndsTheWait) {
  queue_.Add(RunOf(0, {}));
  queue_.Finish(*queue_.Next(), {});
  queue_.Add(RunOf(1, {InputOf(1)}));
  queue_.DropAll();
  EXPECT_TRUE(queue_.TakeAnswers().empty());
  EXPECT_TRUE(TakeWants().empty());
  EXPECT_EQ(queue_.Assigned().tasks_size(), 0);
  std::thread talker([&] { queue_.Close(); });
  EXPECT_EQ(queue_.Next(), nullptr);
  talker.join();
}

}  // namespace
}  // namespace cairn::worker
