#include "coordinator/page/facts.h"

#include <gtest/gtest.h>

namespace cairn::page {
namespace {

wire::JobInfo Job(const std::string& id, const std::string& state) {
  wire::JobInfo job;
  job.set_id(id);
  job.set_state(state);
  job.set_stages(2);
  return job;
}

std::vector<wire::WorkerInfo> Busy(const std::string& task, double task_s, std::uint64_t number = 1) {
  std::vector<wire::WorkerInfo> workers(1);
  workers[0].set_number(number);
  workers[0].set_assigned(task.empty() ? 0 : 1);
  workers[0].set_task(task);
  workers[0].set_task_s(task_s);
  return workers;
}

TEST(FleetTimes, ATaskThatGoesOnIsOneSpanAndAnotherIsAnother) {
  FleetTimes times;
  times.Add(Busy("1-a: task 0", 0.5), 10);
  times.Add(Busy("1-a: task 0", 1.5), 11);
  times.Add(Busy("1-a: task 1", 0.2), 12);
  times.Add(Busy("", 0), 13);
  times.Add(Busy("1-a: task 1", 0.1), 14);  // again
  const auto& spans = times.workers().at(1).spans;
  ASSERT_EQ(spans.size(), 3u);
  EXPECT_EQ(spans[0].job, "1-a");
  EXPECT_EQ(spans[0].task, "task 0");
  EXPECT_DOUBLE_EQ(spans[0].begin_s, 9.5);
  EXPECT_DOUBLE_EQ(spans[0].end_s, 11);
  EXPECT_DOUBLE_EQ(spans[1].begin_s, 11.8);
  EXPECT_DOUBLE_EQ(spans[2].begin_s, 13.9);
}

TEST(FleetTimes, WhatAnEarlierWorkerOfTheNumberDidIsNotItsOwn) {
  FleetTimes times;
  times.Add(Busy("7-a: task 0", 0.5), 10);
  std::vector<wire::WorkerInfo> workers = Busy("7-b: task 0", 0.5);
  workers[0].set_joined_s(2);
  times.Add(workers, 20);
  const auto& spans = times.workers().at(1).spans;
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_EQ(spans[0].job, "7-b");
}

TEST(FleetTimes, StayBoundedForADay) {
  FleetTimes times;
  for (int i = 0; i < 4 * 86400; ++i)
    times.Add(Busy("1-a: task " + std::to_string(i), 0.1, static_cast<std::uint64_t>(1 + i / 100'000)),
              0.25 * i);
  EXPECT_EQ(times.workers().size(), 1u) << "those that are gone are forgotten";
  EXPECT_LE(times.workers().begin()->second.spans.size(), 201u);
}

TEST(SortForPeople, WhatIsNotOverComesFirstAndTheLatestBefore) {
  std::vector<wire::JobInfo> jobs = {Job("1-a", "done"), Job("2-b", "running"), Job("10-c", "failed"),
                                     Job("9-d", "queued")};
  SortForPeople(&jobs);
  std::string order;
  for (const wire::JobInfo& job : jobs) order += job.id() + " ";
  EXPECT_EQ(order, "9-d 2-b 10-c 1-a ");
}

TEST(ActionsFor, AreThoseThatAJobOfItsStateObeys) {
  EXPECT_EQ(ActionsFor(Job("1", "running")), (std::vector<std::string>{"pause", "cancel", "priority"}));
  EXPECT_EQ(ActionsFor(Job("1", "paused")), (std::vector<std::string>{"resume", "cancel", "priority"}));
  EXPECT_EQ(ActionsFor(Job("1", "failed")), (std::vector<std::string>{"retry", "delete"}));
  EXPECT_EQ(ActionsFor(Job("1", "done")), std::vector<std::string>{"delete"});
}

TEST(AdviceOf, SaysWhatToDo) {
  wire::JobInfo failed = Job("1", "failed");
  EXPECT_NE(AdviceOf(failed, 1).find("Retry"), std::string::npos);
  failed.set_input_error(true);
  EXPECT_NE(AdviceOf(failed, 1).find("submit the job again"), std::string::npos);
  EXPECT_NE(AdviceOf(Job("1", "queued"), 0).find("cairn worker"), std::string::npos);
  EXPECT_NE(AdviceOf(Job("1", "paused"), 0).find("Resume"), std::string::npos);
  EXPECT_EQ(AdviceOf(Job("1", "done"), 0), "");
}

TEST(PartDone, IsOfTheStageUnderWay) {
  wire::JobInfo job = Job("1", "running");
  EXPECT_EQ(PartDone(job), -1);
  job.set_round(1);
  job.set_rounds_left(3);
  job.set_tasks(4);
  job.set_tasks_done(2);
  EXPECT_DOUBLE_EQ(PartDone(job), 1.5 / 4);
  EXPECT_EQ(PartDone(Job("1", "done")), 1);
  job.set_eta_s(90);
  job.set_eta_least_s(30);
  job.set_eta_most_s(200);
  EXPECT_EQ(LeftText(job), "0:30 to 3:20");
}

}  // namespace
}  // namespace cairn::page
