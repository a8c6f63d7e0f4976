#include "worker/desk.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>

#include "pipelines/pipeline.h"

namespace cairn::worker {
namespace {

wire::NamedBlob BlobOf(int value) {
  Blob blob;
  blob.PutScalar<std::int32_t>("v", value);
  return wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
}

wire::Assign RunTask(std::uint32_t index, const std::vector<wire::NamedBlob>& inputs) {
  wire::Assign assign;
  assign.mutable_key()->set_job("j");
  assign.mutable_key()->set_task(index);
  for (const wire::NamedBlob& input : inputs)
    assign.mutable_task()->add_inputs()->set_blob(input.hash.Binary());
  return assign;
}

wire::Assign AdvanceTask(const std::vector<wire::NamedBlob>& partials) {
  wire::Assign assign;
  assign.mutable_key()->set_job("j");
  assign.mutable_key()->set_kind(wire::TaskKey::ADVANCE);
  for (const wire::NamedBlob& partial : partials) assign.add_partials(partial.hash.Binary());
  return assign;
}

class DeskTest : public ::testing::Test {
 protected:
  int woken_ = 0;
  Desk desk_{[this] { ++woken_; }};
};

TEST_F(DeskTest, ABlobThatTwoTasksNeedIsWantedOnceAndReachesBoth) {
  const wire::NamedBlob a = BlobOf(1);
  const wire::NamedBlob b = BlobOf(2);
  desk_.Add(RunTask(0, {a, a}));
  desk_.Add(RunTask(1, {b, a}));
  std::vector<Want> wants = desk_.TakeWants();
  ASSERT_EQ(wants.size(), 2u);
  EXPECT_TRUE(desk_.TakeWants().empty());
  desk_.Deliver(a);
  desk_.Deliver(b);
  for (const std::uint32_t index : {0u, 1u}) {
    const TaskPtr task = desk_.Next();
    EXPECT_EQ(task->assign.key().task(), index);
    EXPECT_EQ(task->blobs.at(a.hash), a.blob);
    EXPECT_EQ(task->ticks, index + 1);  // an input that comes counts as progress
    desk_.Finish(*task, {});
  }
  EXPECT_EQ(desk_.TakeAnswers().size(), 2u);
  EXPECT_EQ(woken_, 2);
}

TEST_F(DeskTest, ACancelledTaskNeverComesUpAndARunningOneGivesNoAnswer) {
  desk_.Add(RunTask(0, {}));
  desk_.Add(RunTask(1, {}));
  desk_.Add(RunTask(2, {}));
  const TaskPtr running = desk_.Next();
  desk_.Cancel(RunTask(0, {}).key());
  desk_.Cancel(RunTask(1, {}).key());
  EXPECT_TRUE(running->cancelled);
  EXPECT_EQ(desk_.InHand().tasks_size(), 1);
  desk_.Finish(*running, {});
  EXPECT_EQ(desk_.Next()->assign.key().task(), 2u);
  EXPECT_TRUE(desk_.TakeAnswers().empty());
}

TEST_F(DeskTest, AnotherAttemptAtTheSameTaskIsNotCancelled) {
  desk_.Add(RunTask(0, {}));
  wire::TaskKey other = RunTask(0, {}).key();
  other.set_attempt(7);
  desk_.Cancel(other);
  EXPECT_EQ(desk_.InHand().tasks_size(), 1);
}

TEST_F(DeskTest, WhatTheCoordinatorLacksIsAFailureOfTheTasksThatNeedIt) {
  const wire::NamedBlob a = BlobOf(1);
  desk_.Add(RunTask(0, {a}));
  desk_.Add(RunTask(1, {}));
  desk_.GiveUp(a.hash);
  const TaskPtr first = desk_.Next();
  EXPECT_NE(desk_.FailureOf(*first).find(a.hash.Hex()), std::string::npos);
  desk_.Finish(*first, {});
  EXPECT_TRUE(desk_.FailureOf(*desk_.Next()).empty());
}

TEST_F(DeskTest, AHashOfTheWrongLengthIsAFailureNotACrash) {
  wire::Assign assign = RunTask(0, {});
  assign.mutable_task()->add_inputs()->set_blob("short");
  desk_.Add(assign);
  EXPECT_NE(desk_.FailureOf(*desk_.Next()).find("malformed"), std::string::npos);
}

TEST_F(DeskTest, PartialsAreFetchedAFewAheadOfTheReader) {
  std::vector<wire::NamedBlob> partials(100);
  for (int i = 0; i < 100; ++i) partials[i] = BlobOf(i % 40);  // equal partials are common
  desk_.Add(AdvanceTask(partials));
  const TaskPtr task = desk_.Next();
  std::size_t wanted = 0;
  for (std::size_t i = 0; i < partials.size(); ++i) {
    for (const Want& want : desk_.TakeWants()) {
      EXPECT_FALSE(want.keep);
      ++wanted;
      desk_.Deliver(BlobOf(static_cast<int>(wanted - 1) % 40));
    }
    EXPECT_EQ(desk_.AwaitPartial(*task, i)->Scalar<std::int32_t>("v"), static_cast<int>(i) % 40);
    EXPECT_LT(wanted, i + 20);
  }
  EXPECT_GE(wanted, 40u);
}

TEST_F(DeskTest, AReaderThatWaitsForAPartialIsFreedByACancel) {
  const wire::NamedBlob a = BlobOf(1);
  desk_.Add(AdvanceTask({a}));
  const TaskPtr task = desk_.Next();
  std::thread talker([&] { desk_.Cancel(task->assign.key()); });
  EXPECT_THROW(desk_.AwaitPartial(*task, 0), Cancelled);
  talker.join();
}

TEST_F(DeskTest, WhatStillComputesWhenItWasCalledBackIsTold) {
  desk_.Add(RunTask(0, {}));
  EXPECT_FALSE(desk_.InHand().stuck());
  const TaskPtr task = desk_.Next();
  EXPECT_FALSE(desk_.InHand().stuck());
  desk_.Cancel(task->assign.key());
  EXPECT_TRUE(desk_.InHand().stuck());
  EXPECT_EQ(desk_.InHand().tasks_size(), 0);
  desk_.Finish(*task, {});
  EXPECT_FALSE(desk_.InHand().stuck());
}

TEST_F(DeskTest, DroppingAllForgetsAnswersTooAndClosingEndsTheWait) {
  desk_.Add(RunTask(0, {}));
  desk_.Finish(*desk_.Next(), {});
  desk_.Add(RunTask(1, {BlobOf(1)}));
  desk_.DropAll();
  EXPECT_TRUE(desk_.TakeAnswers().empty());
  EXPECT_TRUE(desk_.TakeWants().empty());
  EXPECT_EQ(desk_.InHand().tasks_size(), 0);
  std::thread talker([&] { desk_.Close(); });
  EXPECT_EQ(desk_.Next(), nullptr);
  talker.join();
}

}  // namespace
}  // namespace cairn::worker
