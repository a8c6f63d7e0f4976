#include "coordinator/eta.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

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
  const double round_s = (20 + 0.85 * 10) / 1.85;  // the last one counts most
  EXPECT_DOUBLE_EQ(StageLeft_s(InItsThirdRound(), 105), 2 * round_s + round_s - 5)
      << "START's 1000 s do not count";
}

TEST(StageLeft, TheRestOfARoundGoesByItsPartThatIsDone) {
  Job job = InItsThirdRound();
  job.tasks.Begin(0, 1);
  job.tasks.Finish(0, H(1));
  const double round_s =
      (8 + 0.85 * 20 + 0.85 * 0.85 * 10) / (1 + 0.85 + 0.85 * 0.85);  // 8: this one, so far
  EXPECT_DOUBLE_EQ(StageLeft_s(job, 102), 2 * round_s + 6);
}

TEST(StageLeft, ARoundThatTakesLongerThanTheOthersDoesNotCountBackwards) {
  EXPECT_DOUBLE_EQ(StageLeft_s(InItsThirdRound(), 1000), 2 * (20 + 0.85 * 10) / 1.85);
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

// A stage as tests/bench/task_times recorded it (its first line says of what): of each round what its step
// said of it and what it took, one task after the other. Replayed as a job of a minute: what counts is the
// shape.
struct Trace {
  struct Row {
    std::uint32_t rounds_left = 0;
    int tasks = 0;
    double run_s = 0, advance_s = 0;
  };
  double start_s = 0;
  std::vector<Row> rows;
};

Trace ReadTrace(const std::string& name) {
  constexpr double kSeconds = 60;
  std::ifstream file(std::string(CAIRN_SOURCE_DIR) + "/coordinator/eta_traces/" + name + ".txt");
  Trace trace;
  double all_s = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    if (line.starts_with('#')) continue;
    if (line.starts_with("start")) {
      words >> word >> trace.start_s;
      all_s += trace.start_s;
      continue;
    }
    Trace::Row row;
    words >> row.rounds_left >> row.tasks >> row.run_s >> row.advance_s;
    EXPECT_TRUE(words) << name << ": " << line;
    all_s += row.run_s + row.advance_s;
    trace.rows.push_back(row);
  }
  EXPECT_FALSE(trace.rows.empty()) << name;
  trace.start_s *= kSeconds / all_s;
  for (Trace::Row& row : trace.rows) {
    row.run_s *= kSeconds / all_s;
    row.advance_s *= kSeconds / all_s;
  }
  return trace;
}

// What is said at a moment, and what is true.
struct Said {
  double part = 0;  // of the whole that is over
  double said_s = 0, true_s = 0;
};

// After each task of each round.
std::vector<Said> Replay(const Trace& trace) {
  double all_s = trace.start_s, now_s = trace.start_s;
  for (const Trace::Row& row : trace.rows) all_s += row.run_s + row.advance_s;
  Job job;
  job.spec = TestJob();
  job.facts.emplace_back().add_rounds()->set_seconds(trace.start_s);
  std::vector<Said> said;
  for (const Trace::Row& row : trace.rows) {
    proto::Step step = TestStep(row.tasks);
    step.set_rounds_left(row.rounds_left);
    job.step = step;
    job.tasks = Round::OfTasks(step);
    job.round_since_s = now_s;
    for (int task = 0; task < row.tasks; ++task) {
      now_s += row.run_s / row.tasks;
      job.tasks.Begin(static_cast<std::uint32_t>(task), 1);
      job.tasks.Finish(static_cast<std::uint32_t>(task), H(1));
      said.push_back({now_s / all_s, StageLeft_s(job, now_s), all_s - now_s});
    }
    now_s += row.advance_s;
    job.facts.back().add_rounds()->set_seconds(row.run_s + row.advance_s);
  }
  return said;
}

// By what factor it is off at most after the first quarter, while a tenth is left or more.
double MostOff(const std::string& name) {
  double most = 1;
  int times = 0;
  for (const Said& said : Replay(ReadTrace(name))) {
    if (said.part < 0.25 || said.part > 0.9) continue;
    EXPECT_GT(said.said_s, 0) << name << ": nothing is said at " << said.part;
    most = std::max({most, said.said_s / said.true_s, said.true_s / said.said_s});
    ++times;
  }
  EXPECT_GT(times, 10) << name;
  return most;
}

TEST(StageLeft, IsNoMoreThanTwiceOffWhereThePipelineKnowsItsRounds) {
  for (const char* name : {"landmark_learning", "local_map"}) EXPECT_LE(MostOff(name), 2) << name;
}

// EM's beliefs grow while it takes in more of the log, and shrink as its map gets sharp.
TEST(StageLeft, IsNotFarOffWhereRoundsAreUnlike) { EXPECT_LE(MostOff("landmark_map_mrclam6"), 2.5); }

}  // namespace
}  // namespace cairn::coordinator
