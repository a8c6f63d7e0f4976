#include "coordinator/eta.h"

#include <gtest/gtest.h>

#include "coordinator/core_bench.h"

namespace cairn::coordinator {
namespace {

// A job whose stage has had rounds of 10 and 20 s; a round of 4 tasks began at 100 s, and 3 are left with it.
Job InItsThirdRound() {
  Job job;
  job.spec = TestJob();
  proto::Step step = TestStep(4);
  step.set_rounds_left(3);
  job.step = step;
  job.tasks = Round::OfTasks(step);
  job.round = 2;
  job.round_since_s = 100;
  proto::StageFacts& facts = job.facts.emplace_back();
  for (const double seconds : {1000.0, 10.0, 20.0}) facts.add_rounds()->set_seconds(seconds);
  return job;
}

TEST(StageLeft, ARoundTakesWhatTheLastOnesTook) {
  EXPECT_DOUBLE_EQ(StageLeft_s(InItsThirdRound(), 105), 2 * 15 + 10) << "START's 1000 s do not count";
}

TEST(StageLeft, TheRestOfARoundGoesByItsPartThatIsDone) {
  Job job = InItsThirdRound();
  job.tasks.Begin(0, 1);
  job.tasks.Finish(0, H(1));
  EXPECT_DOUBLE_EQ(StageLeft_s(job, 102), 2 * 15 + 6);
}

TEST(StageLeft, ARoundThatTakesLongerThanTheOthersDoesNotCountBackwards) {
  EXPECT_DOUBLE_EQ(StageLeft_s(InItsThirdRound(), 1000), 2 * 15);
}

TEST(StageLeft, InTheFirstRoundGoesByItsTasks) {
  Job job = InItsThirdRound();
  job.facts.back().mutable_rounds()->DeleteSubrange(1, 2);
  EXPECT_EQ(StageLeft_s(job, 102), 0) << "nothing is known yet";
  job.tasks.Begin(0, 1);
  job.tasks.Finish(0, H(1));
  EXPECT_DOUBLE_EQ(StageLeft_s(job, 102), 2 * 8 + 6);
}

TEST(StageLeft, IsUnknownWhereNobodyCanTell) {
  Job paused = InItsThirdRound();
  paused.state = proto::JOB_PAUSED;
  EXPECT_EQ(StageLeft_s(paused, 105), 0);
  Job mute = InItsThirdRound();
  mute.step->set_rounds_left(0);
  EXPECT_EQ(StageLeft_s(mute, 105), 0);
  Job unplanned = InItsThirdRound();
  unplanned.step.reset();
  EXPECT_EQ(StageLeft_s(unplanned, 105), 0);
}

}  // namespace
}  // namespace cairn::coordinator
