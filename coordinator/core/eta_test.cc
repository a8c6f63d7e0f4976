#include "coordinator/core/eta.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

constexpr double kSecond = 1e6;  // of cost

// Tasks of a second each, side by side; `later` rounds of `later_s` each are expected to follow.
proto::Step StepOf(int tasks, double later = 0, double later_s = 0, double width = 0) {
  proto::Step step = TestStep(tasks);
  for (proto::Task& task : *step.mutable_tasks()) task.set_cost(static_cast<std::uint64_t>(kSecond));
  if (later > 0) {
    proto::Phase& phase = *step.add_later();
    phase.set_rounds(later);
    phase.set_cost(later * later_s * kSecond);
    phase.set_width(width);
  }
  return step;
}

// A stage whose tasks take just what they are said to.
struct Stage {
  explicit Stage(proto::Step of, double at_s = 0) : step(std::move(of)), tasks(Round::OfTasks(step)) {
    eta.BeginRound(step, tasks, at_s);
  }
  void Look(double now_s) { eta.Look(step, tasks, effort, now_s); }
  double Expected(double now_s) const { return eta.Expected(step, tasks, effort, now_s).expected_s; }
  void Finish(std::uint32_t task, double seconds = 1) {
    tasks.Begin(task, 1);
    tasks.Finish(task, H(task));
    eta.NoteTask(kSecond, seconds);
  }

  proto::Step step;
  Round tasks;
  Effort effort{2, {}};
  Eta eta;
};

TEST(Eta, IsTheWorkOfTheRoundAndOfAllThatFollowsByTheWorkersThereAre) {
  Stage stage(StepOf(8, 3, 8));
  EXPECT_NEAR(stage.Expected(0), 4 + 3 * 4, 1e-9);
  stage.effort.workers = 4;
  EXPECT_NEAR(stage.Expected(0), 2 + 3 * 2, 1e-9);
}

TEST(Eta, WorkIsWhatOneWorkerWouldTakeHoweverManyThereAre) {
  Stage stage(StepOf(8, 3, 8));
  for (const double workers : {1, 100}) {
    stage.effort.workers = workers;
    EXPECT_NEAR(stage.eta.Work_s(stage.step, stage.tasks), 8 + 3 * 8, 1e-9);
  }
  for (std::uint32_t task = 0; task < 4; ++task) stage.Finish(task, 3);
  EXPECT_NEAR(stage.eta.Work_s(stage.step, stage.tasks), 3 * (4 + 3 * 8), 1);
}

TEST(Eta, NoMoreWorkersThanAPhaseIsWideHelp) {
  Stage stage(StepOf(8, 3, 8, 2));
  stage.effort.workers = 100;
  EXPECT_NEAR(stage.Expected(0), 1 + 3 * 4, 1e-9)
      << "a task of a second, then rounds of two tasks side by side";
}

TEST(Eta, TasksThatWaitForEachOtherTakeTheirTimeOneAfterAnother) {
  proto::Step step = StepOf(4);
  for (int task = 1; task < 4; ++task)
    step.mutable_tasks(task)->mutable_inputs(0)->set_task(static_cast<std::uint32_t>(task - 1));
  EXPECT_NEAR(Stage(step).Expected(0), 4, 1e-9);
}

TEST(Eta, GoesByWhatTasksTook) {
  Stage stage(StepOf(8, 3, 8));
  for (std::uint32_t task = 0; task < 4; ++task) stage.Finish(task, 3);
  EXPECT_NEAR(stage.Expected(6), 3 * (2 + 3 * 4), 0.5) << "each took three times its cost";
}

TEST(Eta, WhatRunsIsCountedForAsLongAsItRuns) {
  Stage stage(StepOf(2));
  for (const std::uint32_t task : {0U, 1U}) stage.tasks.Begin(task, 1);
  stage.effort.running_s = {{0, 0.5}, {1, 0.5}};
  EXPECT_NEAR(stage.Expected(0.5), 0.5, 1e-9);
  stage.effort.running_s = {{0, 30}, {1, 30}};
  EXPECT_GT(stage.Expected(30), 1) << "tasks that run for long make all tasks dearer, and are never done";
}

TEST(Eta, RoundsThatTakeLongerThanTheirTasksSaySo) {
  Stage stage(StepOf(2, 10, 2));
  stage.Look(0);
  stage.Finish(0);
  stage.Finish(1);
  stage.eta.EndTasks(0, 3);  // two tasks of a second each, side by side on two workers
  stage.tasks = Round::OfPlan(wire::TaskKey::ADVANCE);
  EXPECT_NEAR(stage.Expected(3), 10 * 3, 5);
}

TEST(Eta, ADVANCETakesWhatItTookOrWhatItsStepSays) {
  Stage stage(StepOf(2, 1, 2));
  stage.eta.EndTasks(0, 1);
  stage.eta.EndRound(5);
  const double usual_s = 4;
  stage.eta.BeginRound(stage.step, stage.tasks, 5);
  EXPECT_NEAR(stage.Expected(5), 1 + usual_s + 1 + usual_s, 1e-9);
  stage.step.set_advance_cost(10 * kSecond);
  EXPECT_NEAR(stage.Expected(5), 1 + 10 + 1 + usual_s, 1e-9);
  stage.tasks = Round::OfPlan(wire::TaskKey::ADVANCE);
  EXPECT_NEAR(stage.Expected(8), 10 - 3 + 1 + usual_s, 1e-9);
}

// What more it may take than its step says: none, 4 s, or 12 s.
TEST(Eta, AnADVANCEThatTakesLongerThanItsStepSaysUsesUpThePhaseWithoutARound) {
  Stage stage(StepOf(2, 1, 0));
  stage.step.clear_later();
  stage.step.set_advance_cost(10 * kSecond);
  proto::Phase& more = *stage.step.add_later();
  more.set_cost(4 * kSecond);
  more.set_width(1);
  more.set_most(3);
  stage.eta.EndTasks(0, 1);
  stage.tasks = Round::OfPlan(wire::TaskKey::ADVANCE);
  const auto expect = [&](double now_s, double least_s, double expected_s, double most_s) {
    const TimeLeft left = stage.eta.Expected(stage.step, stage.tasks, stage.effort, now_s);
    EXPECT_NEAR(left.least_s, least_s, 0.6) << now_s;
    EXPECT_NEAR(left.expected_s, expected_s, 0.6) << now_s;
    EXPECT_NEAR(left.most_s, most_s, 0.6) << now_s;
  };
  expect(1, 10, 14, 22);
  expect(8, 3, 7, 15);
  expect(13, 0.5, 0.5 + 4, 0.5 + 10);
  expect(19, 0.5, 0.5 + 2, 0.5 + 4);  // any of what may be left is as likely
}

TEST(Eta, ShownCountsDownBetweenLooks) {
  Stage stage(StepOf(8, 3, 8));
  EXPECT_EQ(stage.eta.Shown(0).expected_s, 0) << "unknown";
  stage.Look(0);
  EXPECT_NEAR(stage.eta.Shown(0).expected_s, 16, 1e-9);
  EXPECT_NEAR(stage.eta.Shown(5).expected_s, 11, 1e-9);
  EXPECT_GT(stage.eta.Shown(100).expected_s, 0) << "0 would be unknown";
}

TEST(Eta, IsASpanWhereTheDataDecideWhatIsToCome) {
  Stage stage(StepOf(8, 3, 8));
  stage.step.mutable_later(0)->set_least(0.5);
  stage.step.mutable_later(0)->set_most(4);
  const TimeLeft left = stage.eta.Expected(stage.step, stage.tasks, stage.effort, 0);
  EXPECT_NEAR(left.least_s, 4 + 0.5 * 12, 1e-9);
  EXPECT_NEAR(left.expected_s, 4 + 12, 1e-9);
  EXPECT_NEAR(left.most_s, 4 + 4 * 12, 1e-9);
  stage.Look(0);
  EXPECT_NEAR(stage.eta.Shown(0).most_s, 52, 1e-9);
  EXPECT_NEAR(stage.eta.Shown(8).most_s, 26, 1e-9) << "counts down as the figure does";
  EXPECT_NEAR(stage.eta.Shown(8).least_s, 5, 1e-9);
}

TEST(Eta, ShownDoesNotJumpWhereThePlanIsTheSame) {
  Stage stage(StepOf(100, 3, 100));
  stage.Look(0);
  double before_s = stage.eta.Shown(0).expected_s, now_s = 0;
  ASSERT_NEAR(before_s, 200, 1e-9);
  for (std::uint32_t task = 0; task < 50; ++task) {
    stage.Finish(task, 4);  // not the second that was expected
    now_s += 2;
    stage.Look(now_s);
    const double share = 2 * (Eta::kShare + Eta::kYoung / now_s), counted_s = before_s - 2;
    const double shown_s = stage.eta.Shown(now_s).expected_s;
    EXPECT_LE(shown_s, counted_s * std::exp(share) + 2 * Eta::kSlack + 1e-9) << now_s;
    EXPECT_GE(shown_s, counted_s * std::exp(-share) - 2 * Eta::kSlack - 1e-9) << now_s;
    before_s = shown_s;
  }
  EXPECT_NEAR(before_s, stage.Expected(now_s), 0.05 * before_s) << "in the end it is what is expected";
}

TEST(Eta, ShownJumpsWhereThePlanChangesOrTheWorkersDo) {
  Stage stage(StepOf(8, 30, 8));
  stage.Look(0);
  EXPECT_NEAR(stage.eta.Shown(0).expected_s, 124, 1e-9);
  stage.effort.workers = 4;
  stage.Look(0.1);
  EXPECT_NEAR(stage.eta.Shown(0.1).expected_s, 62, 1e-9);
  stage.eta.BeginRound(StepOf(8, 5, 8), stage.tasks, 1);
  stage.step = StepOf(8, 5, 8);
  stage.Look(1);
  EXPECT_NEAR(stage.eta.Shown(1).expected_s, 12, 1e-9) << "30 rounds were announced, and are 5";
}

TEST(Eta, OfAStepThatIsAsAnnouncedDoesNotJump) {
  Stage stage(StepOf(8, 3, 8));
  stage.Look(0);
  stage.step = StepOf(8, 2, 9);  // not quite
  stage.eta.BeginRound(stage.step, stage.tasks, 1);
  stage.Look(1);
  EXPECT_LT(std::abs(stage.eta.Shown(1).expected_s - 15), 15 * (std::exp(2.02) - 1) + 0.5);
  EXPECT_NE(stage.eta.Shown(1).expected_s, 0);
}

// Through the core.
TEST(Eta, IsToldOfARunningJobAndOfNoOther) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Do(PersistDone{"a", 1});
  EXPECT_EQ(fixture.Info().eta_s(), 0) << "nobody works at it";
  fixture.Join("w");
  fixture.AnswerPlan(fixture.Next(), StepOf(10));
  fixture.Advance(0.1);
  EXPECT_NEAR(fixture.Info().eta_s(), 10, 0.2);
  fixture.Do(PauseJob{"a", ""});
  EXPECT_EQ(fixture.Info().eta_s(), 0) << "paused";
  fixture.Advance(5);
  fixture.Do(ResumeJob{"a", ""});
  fixture.Advance(0.1);
  EXPECT_GT(fixture.Info().eta_s(), 1) << "goes on";
}

TEST(Eta, TwoJobsShareTheWorkers) {
  CoreFixture fixture;
  fixture.Join("v");
  fixture.Join("w");
  for (const char* id : {"a", "b"}) {
    fixture.Submit(id);
    fixture.Do(PersistDone{id, 1});
  }
  fixture.AnswerPlan(fixture.Next(), StepOf(10));
  fixture.AnswerPlan(fixture.Next(), StepOf(10));
  fixture.Advance(0.1);
  EXPECT_NEAR(fixture.Info("a").eta_s(), 10, 0.5);
}

}  // namespace
}  // namespace cairn::coordinator
