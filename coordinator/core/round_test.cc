#include "coordinator/core/round.h"

#include <gtest/gtest.h>

#include "coordinator/core/job.h"
#include "coordinator/core/testing/core_fixture.h"
#include "schema/blob_part.h"

namespace cairn::coordinator {
namespace {

proto::Step Chain(int tasks) {
  proto::Step step = TestStep(tasks);
  for (int i = 1; i < tasks; ++i) {
    proto::InputRef& input = *step.mutable_tasks(i)->add_inputs();
    input.set_name("before");
    input.set_task(static_cast<std::uint32_t>(i - 1));
  }
  return step;
}

TEST(Round, ReadyTasksComeByCostThenIndex) {
  proto::Step step = TestStep(3);
  step.mutable_tasks(1)->set_cost(5);
  Round round = Round::OfTasks(step);
  for (const std::uint32_t want : {1u, 0u, 2u}) {
    ASSERT_EQ(round.NextReady(), want);
    round.Begin(want, 1);
  }
  EXPECT_FALSE(round.HasReady());
}

TEST(Round, ATaskWaitsForThePartialsThatItNames) {
  Round round = Round::OfTasks(Chain(3));
  EXPECT_EQ(round.NextReady(), 0u);
  round.Begin(0, 1);
  EXPECT_FALSE(round.HasReady());
  round.Finish(0, H(1));
  EXPECT_EQ(round.NextReady(), 1u);
  EXPECT_EQ(round.task(2).status, TaskStatus::kWaiting);
}

TEST(Round, NamingOnePartialTwiceWaitsOnce) {
  proto::Step step = Chain(2);
  *step.mutable_tasks(1)->add_inputs() = step.tasks(1).inputs(1);
  Round round = Round::OfTasks(step);
  round.Begin(0, 1);
  round.Finish(0, H(1));
  EXPECT_EQ(round.task(1).status, TaskStatus::kReady);
}

TEST(Round, WithdrawingTheLastAttemptMakesATaskReadyAgain) {
  Round round = Round::OfTasks(TestStep(1));
  EXPECT_EQ(round.Begin(0, 1), 1u);
  EXPECT_EQ(round.Begin(0, 1), 2u);
  EXPECT_TRUE(round.Withdraw(0, 1));
  EXPECT_FALSE(round.HasReady());
  EXPECT_FALSE(round.Withdraw(0, 1));
  EXPECT_TRUE(round.Withdraw(0, 2));
  EXPECT_TRUE(round.HasReady());
  EXPECT_EQ(round.Begin(0, 1), 3u);
}

TEST(Round, AnAnswerFromBeforeARestartMayComeBeforeItsTaskIsReady) {
  Round round = Round::OfTasks(Chain(2));
  round.Finish(1, H(2));
  round.Begin(0, 1);
  round.Finish(0, H(1));
  EXPECT_TRUE(round.AllDone());
  EXPECT_FALSE(round.HasReady());
}

TEST(Round, AWithdrawnTaskThatIsAnsweredIsNoLongerReady) {
  Round round = Round::OfTasks(TestStep(1));
  round.Withdraw(0, round.Begin(0, 1));
  round.Finish(0, H(1));
  EXPECT_FALSE(round.HasReady());
  EXPECT_EQ(round.done_count(), 1u);
}

TEST(CheckStep, NamesWhatIsWrong) {
  EXPECT_EQ(CheckStep(Chain(3)), "");
  proto::Step step = Chain(3);
  step.mutable_tasks(1)->set_index(2);
  EXPECT_NE(CheckStep(step).find("task 1 (toy)"), std::string::npos);
  step = Chain(3);
  step.mutable_tasks(1)->mutable_inputs(1)->set_task(1);
  EXPECT_NE(CheckStep(step).find("not earlier"), std::string::npos);
  step = Chain(3);
  step.mutable_tasks(0)->mutable_inputs(0)->set_blob("short");
  EXPECT_NE(CheckStep(step).find("'log' has no hash"), std::string::npos);
  step = Chain(1);
  step.set_result("short");
  EXPECT_NE(CheckStep(step), "");
  step = Chain(1);
  (*step.mutable_state()->mutable_blobs())["map"] = "short";
  EXPECT_NE(CheckStep(step).find("'map'"), std::string::npos);
  step = Chain(1);
  step.mutable_state()->set_so_far("short");
  EXPECT_EQ(CheckStep(step), "what there is to see of the state has no hash");
  step = Chain(3);
  step.mutable_tasks(1)->set_kind(std::string(1000, 'x'));
  EXPECT_EQ(CheckStep(step), "task 1: its kind is no name")
      << "a reason does not repeat what may be of any length";
}

// Whether a blob has such rows only who has it can tell.
// 600,000 of them stopped the event loop for seconds.
TEST(CheckStep, AStateOfTooManyFiguresIsRefused) {
  proto::Step step = Chain(2);
  for (int i = 0; i <= 20'000; ++i) (*step.mutable_state()->mutable_scalars())[std::to_string(i)];
  EXPECT_EQ(CheckStep(step), "a state of more than 20000 figures or blobs");
  step.mutable_state()->clear_scalars();
  EXPECT_EQ(CheckStep(step), "");
  for (int i = 0; i <= 500'000; ++i) (*step.mutable_tasks(1)->mutable_params())[std::to_string(i)];
  EXPECT_EQ(CheckStep(step), "a round whose tasks have more than 500000 parameters");
}

TEST(CheckStep, APartIsOfABlobAndHasRowsThatCanBe) {
  const auto with = [](const proto::BlobPart& part, std::int64_t rows = 0, bool of_task = false) {
    proto::Step step = TestStep(2);
    proto::InputRef& input = *step.mutable_tasks(1)->mutable_inputs(0);
    *input.mutable_part() = part;
    input.set_row_count(rows);
    if (of_task) input.set_task(0);
    return CheckStep(step);
  };
  EXPECT_EQ(with(RowsPart("range_m", 3, 4)), "");
  EXPECT_EQ(with(HeadPart("range_m")), "");
  EXPECT_EQ(with(RowsPart("range_m", -1, 4)),
            "task 1 (toy), its input 'log': a part of a blob has rows from 0 on, and at least one, not 4 "
            "from -1 on");
  for (const std::string& wrong :
       {with(RowsPart("range_m", 3, INT64_MAX)), with(proto::BlobPart()), with(RowsPart("range_m", 3, 4), 1),
        with(RowsPart("range_m", 3, 4), 0, true)})
    EXPECT_NE(wrong, "");
}

TEST(CheckStep, ARoundHasALimit) {
  proto::Step step;
  for (int i = 0; i <= 200'000; ++i) step.add_tasks();
  EXPECT_EQ(CheckStep(step), "a round of more than 200000 tasks");
}

TEST(CutReason, KeepsWhatPeopleRead) {
  EXPECT_EQ(CutReason("short"), "short");
  EXPECT_LT(CutReason(std::string(1'000'000, 'x')).size(), 5000U);
}

TEST(HashOfStep, DoesNotDependOnTheOrderInWhichAMapWasFilled) {
  proto::Step a, b;
  for (int i = 0; i < 50; ++i) {
    (*a.mutable_state()->mutable_blobs())["k" + std::to_string(i)] = H(1).Binary();
    (*b.mutable_state()->mutable_blobs())["k" + std::to_string(49 - i)] = H(1).Binary();
  }
  EXPECT_EQ(HashOfStep(a), HashOfStep(b));
  b.set_note("x");
  EXPECT_NE(HashOfStep(a), HashOfStep(b));
}

}  // namespace
}  // namespace cairn::coordinator
