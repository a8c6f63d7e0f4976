#include "coordinator/cli/output/service_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace cairn::cli {
namespace {

coordinator::JobList ThreeJobs() {
  coordinator::JobList list;
  for (const char* state : {"running", "done", "done"}) list.jobs.emplace_back().set_state(state);
  list.refused = {{"key", 2}, {"right", 1}};
  return list;
}

std::vector<wire::WorkerInfo> TwoWorkers() {
  std::vector<wire::WorkerInfo> workers(2);
  workers[0].set_number(3);
  workers[0].set_host("hub");
  workers[0].set_pid(812);
  workers[0].set_state("busy");
  workers[0].set_assigned(2);
  workers[0].set_task("1-museum: task 3 (forward) of round 5 of stage 'map'");
  workers[0].set_task_s(65);
  workers[0].set_silent_s(0.4);
  workers[1].set_number(12);
  workers[1].set_host("far");
  workers[1].set_state("idle");
  return workers;
}

TEST(ServiceText, CountsJobsAndWorkersByStateAndWhatWasRefused) {
  const std::string text = ServiceText(ThreeJobs(), TwoWorkers());
  EXPECT_NE(text.find("jobs     2 done, 1 running\nworkers  1 busy, 1 idle\nrefused  key 2, right 1\n"),
            std::string::npos)
      << text;
}

TEST(ServiceText, BeginsWithWhatIsWrong) {
  coordinator::JobList list = ThreeJobs();
  list.warning = "the list of keys cannot be read";
  EXPECT_TRUE(ServiceText(list, {}).starts_with("warning  the list of keys cannot be read\njobs "))
      << ServiceText(list, {});
  EXPECT_EQ(nlohmann::json::parse(ServiceJson(list, {})).at("warning"), list.warning);
}

TEST(ServiceText, SaysWhatEachWorkerRunsAndForHowLong) {
  const std::string text = ServiceText(ThreeJobs(), TwoWorkers());
  EXPECT_NE(text.find("3       hub   812      busy   2         1:05  0:00    1-museum: task 3 (forward)"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("12      far   0        idle   0               0:00\n"), std::string::npos) << text;
}

TEST(ServiceText, OfAnEmptyServiceSaysWhatIsMissing) {
  EXPECT_EQ(ServiceText({}, {}),
            "jobs     none\nworkers  none (start 'cairn worker')\nrefused  nothing\nstore    0 B\n");
}

TEST(ServiceText, JsonHoldsTheSame) {
  const nlohmann::json json = nlohmann::json::parse(ServiceJson(ThreeJobs(), TwoWorkers()));
  EXPECT_EQ(json.at("jobs").at("done"), 2);
  EXPECT_EQ(json.at("refused").at("key"), 2);
  EXPECT_EQ(json.at("store").at("limit_bytes"), 0);
  ASSERT_EQ(json.at("workers").size(), 2u);
  EXPECT_EQ(json.at("workers").at(0).at("number"), 3);
  EXPECT_EQ(json.at("workers").at(0).at("task_s"), 65);
  EXPECT_EQ(json.at("workers").at(1).at("state"), "idle");
}

}  // namespace
}  // namespace cairn::cli
