// Which worker gets which task.
#include <gtest/gtest.h>

#include <map>

#include "coordinator/core/testing/core_fixture.h"
#include "schema/blob_part.h"

namespace cairn::coordinator {
namespace {

TEST(CoreDispatch, GetsAsManyTasksAsItHasSlots) {
  CoreFixture fixture;
  Begin(fixture, 5, 3);
  EXPECT_EQ(fixture.assigned.size(), 3u);
  fixture.AnswerRun(fixture.Next(), H(10));
  EXPECT_EQ(fixture.assigned.size(), 3u);
}

TEST(CoreDispatch, ALateJoinerTakesOverWhatWaitsBehindAnother) {
  CoreFixture fixture;
  Begin(fixture, 3, 3);
  fixture.assigned.clear();
  fixture.Join("late", 3);
  const auto moved = fixture.Next();
  EXPECT_EQ(moved.peer, "late");
  EXPECT_EQ(moved.assign.key().task(), 2u);
  EXPECT_EQ(moved.assign.key().attempt(), 2u);
  const auto cancels = fixture.Sent(&wire::Envelope::has_cancel);
  ASSERT_EQ(cancels.size(), 1u);
  EXPECT_EQ(cancels[0].peer, "w");
  EXPECT_TRUE(fixture.assigned.empty()) << "a worker that has something takes no more";
}

// Else a coordinator that has more to do than it can gives itself more.
TEST(CoreDispatch, WhereMessagesWaitToBeReadNoTaskIsMovedOrCopiedAndNobodyIsLost) {
  CoreFixture fixture;
  Begin(fixture, 7, 4);
  fixture.Join("x", 3);
  for (std::uint64_t i = 0; i < 7; ++i) {
    const auto task = fixture.Next();
    fixture.now_s += 0.1;
    if (task.assign.key().task() != 0) fixture.AnswerRun(task, H(10 + i));
  }
  const double lease_s = CoreOptions().lease_s;
  fixture.assigned.clear();
  const auto pass = [&](double seconds, bool behind) {
    for (; seconds > 0; --seconds) {
      ++fixture.now_s;
      fixture.Do(Tick{behind});
    }
  };
  pass(1.5 * lease_s, true);
  fixture.Heartbeat("x");
  fixture.Heartbeat("w");  // as it was before it had the task, for all that is known
  EXPECT_TRUE(fixture.assigned.empty());
  EXPECT_EQ(fixture.core.fleet().size(), 2u);
  pass(1, false);
  EXPECT_FALSE(fixture.assigned.empty()) << "a copy of the task that none has answered";
  pass(6 * lease_s, true);
  EXPECT_EQ(fixture.core.fleet().size(), 0u) << "one that is always behind loses who is gone, too";
}

TEST(CoreDispatch, AnIdleWorkerCopiesAStragglerAndTheFirstAnswerCounts) {
  CoreFixture fixture;
  Begin(fixture, 4);
  fixture.Join("x");
  auto on_w = fixture.Next();
  ASSERT_EQ(on_w.peer, "w");
  for (std::uint64_t i = 0; i < 3; ++i) {
    fixture.now_s += 0.5;
    fixture.AnswerRun(fixture.Next(), H(10 + i));
  }
  fixture.Heartbeat("w", {on_w}, 1);
  fixture.Advance(0.4);
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Heartbeat("x");
  fixture.Advance(0.2);
  const auto copy = fixture.Next();
  EXPECT_EQ(copy.peer, "x");
  EXPECT_EQ(copy.assign.key().task(), on_w.assign.key().task());
  fixture.Advance(1);
  EXPECT_TRUE(fixture.assigned.empty()) << "one copy is enough";
  fixture.AnswerRun(copy, H(20));
  const auto cancels = fixture.Sent(&wire::Envelope::has_cancel);
  ASSERT_EQ(cancels.size(), 1u);
  EXPECT_EQ(cancels[0].peer, "w");
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
  fixture.AnswerRun(on_w, H(20));
  EXPECT_TRUE(fixture.alarms.empty());
}

// A round of tasks that read a row each of the log of TestJob.
proto::Step StepOfRows(const std::vector<int>& rows) {
  proto::Step step = TestStep(static_cast<int>(rows.size()));
  for (int i = 0; i < step.tasks_size(); ++i) {
    proto::InputRef& input = *step.mutable_tasks(i)->mutable_inputs(0);
    *input.mutable_part() = RowsPart("range_m", rows[static_cast<std::size_t>(i)], 1);
  }
  return step;
}

// However they are ordered in the next round: what goes over the wire goes there once.
TEST(CoreDispatch, TasksGoToWhoeverWasGivenTheSamePartsBefore) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("v", 2);
  fixture.Join("w", 2);
  fixture.AnswerPlan(fixture.Next(), StepOfRows({0, 1, 2, 3}));
  std::map<std::int64_t, std::string> read_by;
  for (std::uint64_t i = 0; i < 4; ++i) {
    const auto task = fixture.Next();
    read_by[task.assign.task().inputs(0).part().first_row()] = task.peer;
    fixture.AnswerRun(task, H(10 + i));
  }
  EXPECT_NE(read_by[0], read_by[1]);
  std::vector<int> again;  // those of one worker first
  for (const char* worker : {"v", "w"})
    for (const auto& [row, peer] : read_by)
      if (peer == worker) again.push_back(static_cast<int>(row));
  ASSERT_EQ(again.size(), 4u);
  fixture.AnswerPlan(fixture.Next(), StepOfRows(again));
  for (int i = 0; i < 4; ++i) {
    const auto task = fixture.Next();
    EXPECT_EQ(read_by[task.assign.task().inputs(0).part().first_row()], task.peer) << i;
  }
}

TEST(CoreDispatch, PartsOfAWorkerThatIsGoneGoToAnother) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("v", 2);
  fixture.AnswerPlan(fixture.Next(), StepOfRows({0, 1}));
  for (std::uint64_t i = 0; i < 2; ++i) fixture.AnswerRun(fixture.Next(), H(10 + i));
  const auto advance = fixture.Next();
  fixture.Join("w", 2);
  fixture.AnswerPlan(advance, StepOfRows({0, 1}));
  const auto on_v = fixture.Next(), on_w = fixture.Next();
  EXPECT_EQ(on_v.peer, "v");
  EXPECT_EQ(on_w.peer, "w") << "who is idle takes what another has read";
  fixture.Do(WorkerLeave{"v"});
  const auto again = fixture.Next();
  EXPECT_EQ(again.peer, "w");
  EXPECT_EQ(again.assign.key().task(), on_v.assign.key().task());
}

TEST(CoreDispatch, AChainStaysOnTheWorkerThatHasThePartial) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("v");
  fixture.Join("w");
  proto::Step step = TestStep(4);  // two chains: 0-2 and 1-3
  step.mutable_tasks(2)->mutable_inputs(0)->set_task(0);
  step.mutable_tasks(3)->mutable_inputs(0)->set_task(1);
  fixture.AnswerPlan(fixture.Next(), step);
  const auto t0 = fixture.Next(), t1 = fixture.Next();
  ASSERT_NE(t0.peer, t1.peer);
  fixture.AnswerRun(t1, H(11));
  const auto t3 = fixture.Next();
  EXPECT_EQ(t3.assign.key().task(), 3u);
  EXPECT_EQ(t3.peer, t1.peer);
}

TEST(CoreDispatch, PlacementPrefersTheWorkerThatHasTheInputsWhereBothAreFree) {
  Fleet fleet;
  wire::Hello hello;
  hello.set_slots(2);
  fleet.Add("v", hello, 0);
  fleet.NoteBlob(fleet.Add("w", hello, 0), H(1));
  EXPECT_EQ(fleet.Place(std::vector{H(1)})->peer, "w");
  EXPECT_EQ(fleet.Place(std::vector{H(2)})->peer, "v");
  fleet.Give(*fleet.Find("w"), wire::TaskKey(), 0);
  EXPECT_EQ(fleet.Place(std::vector{H(1)})->peer, "v")
      << "a free worker comes before one that has the inputs";
}

}  // namespace
}  // namespace cairn::coordinator
