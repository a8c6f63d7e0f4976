// Answers of workers: whose count, what of them is kept, and what their worker may read.
#include <gtest/gtest.h>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

TEST(CoreAnswers, ALateAnswerOfAWithdrawnAttemptCountsBecauseTasksArePure) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  const auto first = fixture.Next(), second = fixture.Next();
  fixture.Join("w", 2);  // says Hello again: has forgotten both
  fixture.assigned.clear();
  fixture.AnswerRun(first, H(10));
  EXPECT_EQ(fixture.Info().tasks_done(), 1u);
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_cancel).size(), 1u);
  fixture.Fail(second, "failure of an attempt that was withdrawn");
  EXPECT_TRUE(fixture.core.FindJob("a")->failures.empty());
}

TEST(CoreAnswers, AnAnswerToATaskThatWasNeverItsWorkersChangesNothing) {
  CoreFixture fixture;
  Begin(fixture, 2);
  const auto task = fixture.Next();
  fixture.Join("x");
  const auto other = fixture.Next();
  CoreFixture::Assigned stolen = task;  // or from before a restart of the coordinator
  stolen.peer = "x";
  fixture.Fail(stolen, "not its own", true);
  EXPECT_EQ(fixture.Info().state(), "running");
  EXPECT_EQ(fixture.All<Refused>().size(), 1u);
  fixture.AnswerRun(stolen, H(66));
  ASSERT_EQ(fixture.All<Refused>().size(), 1u);
  EXPECT_EQ(fixture.All<Refused>()[0].peer, "x");
  EXPECT_EQ(fixture.All<Refused>()[0].refusal.kind, wire::RefusalKind::kTask);
  EXPECT_EQ(fixture.All<DropBlobs>().size(), 1u) << "its blob is not kept";
  EXPECT_EQ(fixture.Info().tasks_done(), 0u);
  EXPECT_TRUE(fixture.Sent(&wire::Envelope::has_cancel).empty());
  fixture.AnswerRun(task, H(10));
  EXPECT_EQ(fixture.Info().tasks_done(), 1u);
  fixture.AnswerRun(stolen, H(66));
  EXPECT_EQ(fixture.Info().state(), "running") << "nor does it contradict anybody";
  EXPECT_TRUE(fixture.alarms.empty());
  CoreFixture::Assigned forged = other;
  forged.assign.mutable_key()->set_attempt(7);
  fixture.AnswerRun(forged, H(66));
  EXPECT_EQ(fixture.All<Refused>().size(), 1u);
  fixture.AnswerRun(other, H(11));
  EXPECT_TRUE(fixture.All<Refused>().empty());
  const auto plan = fixture.Next();
  CoreFixture::Assigned stolen_plan = plan;
  stolen_plan.peer = plan.peer == "x" ? "w" : "x";
  fixture.AnswerPlan(stolen_plan, TestStep(1));
  EXPECT_EQ(fixture.Info().round(), 0u);
  fixture.AnswerPlan(plan, TestStep(1));
  EXPECT_EQ(fixture.Info().round(), 1u);
}

TEST(CoreAnswers, ABlobThatAnAnswerDoesNotNameIsAFailureAndIsNotKept) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  const auto task = fixture.Next();
  wire::Done done;
  *done.mutable_key() = task.assign.key();
  done.set_partial(H(10).Binary());
  fixture.Do(TaskDone{"w", done, {H(10), H(11)}});
  EXPECT_EQ(fixture.Info().tasks_done(), 0u);
  ASSERT_EQ(fixture.All<DropBlobs>().size(), 1u);
  EXPECT_EQ(fixture.All<DropBlobs>()[0].hashes.size(), 2u);
}

TEST(CoreAnswers, AWorkerMayReadOnlyWhatItWasHandedOrMade) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Join("x");
  const auto task = fixture.Next();
  const Hash input = TaskInputs(*fixture.core.FindJob("a"), 0).at(0);
  EXPECT_TRUE(fixture.core.MayRead(task.peer, input));
  EXPECT_FALSE(fixture.core.MayRead("x", input));
  EXPECT_FALSE(fixture.core.MayRead("nobody", input));
  EXPECT_FALSE(fixture.core.MayRead(task.peer, H(4711)));
}

// By naming it in an answer: job "a" holds H(2000), job "b" is another's.
TEST(CoreAnswers, AWorkerDoesNotGetToReadABlobByNamingIt) {
  for (const bool in_a_plan : {false, true}) {
    CoreFixture fixture;
    proto::Job secret = TestJob();
    (*secret.mutable_input_blobs())["log"] = H(2000).Binary();
    fixture.Submit("a", secret);
    fixture.Do(PauseJob{"a"});
    fixture.Submit("b");
    fixture.Join("w");
    const auto start = fixture.Next();
    ASSERT_EQ(start.assign.key().job(), "b");
    if (in_a_plan) {
      proto::Step step = TestStep(1);
      (*step.mutable_state()->mutable_blobs())["mine"] = H(2000).Binary();
      fixture.AnswerPlan(start, step);
      EXPECT_EQ(fixture.core.FindJob("b")->step, std::nullopt);
    } else {
      fixture.AnswerPlan(start, TestStep(2));
      wire::Done done;
      *done.mutable_key() = fixture.Next().assign.key();
      done.set_partial(H(2000).Binary());
      fixture.Do(TaskDone{"w", done, {}});
      EXPECT_EQ(fixture.Info("b").tasks_done(), 0u);
    }
    EXPECT_FALSE(fixture.core.MayRead("w", H(2000))) << in_a_plan;
  }
}

// Nor is anything that its job holds sent again: a plan names the state's blobs of the round before.
TEST(CoreAnswers, AnAnswerMayNameWhatItsJobHolds) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("w");
  proto::Step step = TestStep(1);
  (*step.mutable_state()->mutable_blobs())["kept"] = H(5).Binary();
  fixture.AnswerPlan(fixture.Next(), step, {H(5)});
  fixture.AnswerRun(fixture.Next(), H(10));
  fixture.Do(WorkerLost{"w"});
  fixture.assigned.clear();
  fixture.Join("x");  // which has neither
  (*step.mutable_state()->mutable_blobs())["partial"] = H(10).Binary();
  const auto plan = fixture.Next();
  ASSERT_EQ(plan.peer, "x");
  fixture.AnswerPlan(plan, step);
  EXPECT_EQ(fixture.Info().round(), 1u);
}

// An answer that lacks its blob.
void AnswerMalformed(CoreFixture& fixture, const CoreFixture::Assigned& task) {
  wire::Done done;
  *done.mutable_key() = task.assign.key();
  done.set_partial(H(77).Binary());
  fixture.Do(TaskDone{task.peer, done, {}});
}

TEST(CoreAnswers, AWorkerWhoseAnswerIsMalformedGetsNoMoreOfThatJobWhereThereAreOthers) {
  CoreFixture fixture;
  Begin(fixture, 8, 3);
  fixture.Join("x", 2);
  auto first = fixture.Next();
  ASSERT_EQ(first.peer, "w");
  AnswerMalformed(fixture, first);
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_cancel).size(), 2u) << "nor are its other answers waited for";
  ASSERT_EQ(fixture.core.FindJob("a")->failures.size(), 1u);
  EXPECT_NE(fixture.core.FindJob("a")->failures[0].find("host-w"), std::string::npos) << "says whose it was";
  EXPECT_EQ(fixture.core.Workers().at(0).failures(), 1u);
  EXPECT_TRUE(fixture.core.fleet().Find("w")->assigned.empty());
  std::erase_if(fixture.assigned, [](const auto& task) { return task.peer == "w"; });
  for (std::uint64_t i = 0; i < 8; ++i) {
    const auto task = fixture.Next();
    EXPECT_EQ(task.peer, "x");
    fixture.AnswerRun(task, H(10 + i));
    fixture.Advance(0.1);
  }
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
  EXPECT_EQ(fixture.core.FindJob("a")->failures.size(), 1u);
  fixture.Submit("b");
  EXPECT_EQ(fixture.Next().peer, "w") << "other jobs do not suffer for what may be this job's fault";
}

TEST(CoreAnswers, WithNobodyElseAWorkersMalformedAnswersFailTheJobInTheEnd) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Join("x");
  AnswerMalformed(fixture, fixture.Next());
  auto again = fixture.Next();
  ASSERT_EQ(again.peer, "x");
  fixture.Do(DrainWorker{"x"});
  fixture.Do(WorkerLeave{"x"});
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(fixture.Info().state(), "running");
    again = fixture.Next();
    ASSERT_EQ(again.peer, "w");
    AnswerMalformed(fixture, again);
  }
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_NE(fixture.Info().reason().find("failed 3 times, last: its answer came without its blob, by worker"),
            std::string::npos)
      << fixture.Info().reason();
}

}  // namespace
}  // namespace cairn::coordinator
