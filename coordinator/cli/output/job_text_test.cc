#include "coordinator/cli/output/job_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace cairn::cli {
namespace {

wire::JobInfo AJobWithFailures() {
  wire::JobInfo job;
  job.set_id("1-museum");
  job.set_state("running");
  job.set_stages(2);
  job.set_retries(7);
  job.add_failures("task 3 (forward) of round 1 of stage 'map': worker 12 on hub died while it ran");
  return job;
}

TEST(JobText, SaysWhatFailedAndWhy) {
  const std::string text = JobText(AJobWithFailures());
  EXPECT_NE(text.find("retries  7 in all"), std::string::npos) << text;
  EXPECT_NE(text.find("worker 12 on hub died while it ran"), std::string::npos) << text;
}

TEST(JobText, SaysNothingOfFailuresWhereThereAreNone) {
  wire::JobInfo job = AJobWithFailures();
  job.set_retries(0);
  job.clear_failures();
  EXPECT_EQ(JobText(job).find("retries"), std::string::npos);
}

TEST(JobText, SaysWhereItStandsAndWhatIsLeft) {
  wire::JobInfo job = AJobWithFailures();
  job.set_stage_name("landmarks");
  job.set_round(3);
  job.set_rounds_left(4);
  job.set_tasks(20);
  job.set_tasks_done(10);
  job.set_workers(2);
  EXPECT_NE(JobText(job).find("left     unknown\n"), std::string::npos) << JobText(job);
  job.set_eta_s(40);
  const std::string text = JobText(job);
  EXPECT_NE(
      text.find("stage    1 of 2, landmarks\nround    3, about 4 to do\ntasks    10 of 20 in this round\n"
                "workers  2 at work on it\n"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("left     about 0:40 of this stage, and 1 stage more\n"), std::string::npos) << text;
  job.set_state("done");
  EXPECT_EQ(JobText(job).find("left "), std::string::npos) << JobText(job);
}

TEST(JobTable, HasALineAJobWithWhatIsLeftOrWhyItWaits) {
  wire::JobInfo job = AJobWithFailures();
  job.set_name("museum");
  job.set_stage_name("landmarks");
  job.set_tasks(20);
  job.set_tasks_done(10);
  job.set_eta_s(40);
  job.set_note("iteration 3");
  wire::JobInfo paused = job;
  paused.set_state("paused");
  paused.set_reason("cannot save: no space left on device");
  const std::string text = JobTable({job, paused});
  EXPECT_NE(
      text.find("1-museum  museum  running  1/2 landmarks  0      10/20  0        0:00  0:40  iteration 3\n"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("cannot save: no space left on device\n"), std::string::npos) << text;
}

TEST(JobTable, SaysWhoseAJobIsWhereThereAreSeveralOwners) {
  wire::JobInfo anns = AJobWithFailures(), bobs = anns;
  anns.set_owner("ann");
  EXPECT_EQ(JobTable({anns, anns}).find("owner"), std::string::npos);
  bobs.set_owner("0123456789abcdefghij0123456789abcdefghij");
  const std::string text = JobTable({anns, bobs});
  EXPECT_NE(text.find("job       name  owner"), std::string::npos) << text;
  EXPECT_NE(text.find("ann "), std::string::npos) << text;
  EXPECT_EQ(text.find(bobs.owner()), std::string::npos) << "a key without a name, whole";
  EXPECT_NE(JobText(anns).find("owner    ann\n"), std::string::npos) << JobText(anns);
}

TEST(JobText, SaysWhatWasLostApartFromWhatFailed) {
  wire::JobInfo job = AJobWithFailures();
  EXPECT_EQ(JobText(job).find("lost "), std::string::npos);
  job.set_lost(3);
  EXPECT_NE(JobText(job).find("lost     3 with their machines, which are no failures\n"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(JobJson(job)).at("lost"), 3);
}

TEST(JobText, JsonHoldsTheSame) {
  const nlohmann::json json = nlohmann::json::parse(JobJson(AJobWithFailures()));
  EXPECT_EQ(json.at("retries"), 7);
  ASSERT_EQ(json.at("failures").size(), 1u);
  EXPECT_EQ(json.at("id"), "1-museum");
  EXPECT_TRUE(json.at("eta_s").is_null()) << "unknown";
  EXPECT_TRUE(json.at("eta_most_s").is_null());
  EXPECT_EQ(json.at("workers"), 0);
}

TEST(JobText, SaysWhatTheStoreHoldsAndMayHold) {
  coordinator::JobList list;
  list.store = {1'500'000, 2'000'000'000};
  const nlohmann::json json = nlohmann::json::parse(JobsJson(list));
  EXPECT_EQ(json.at("store").at("bytes"), 1'500'000);
  EXPECT_EQ(json.at("store").at("limit_bytes"), 2'000'000'000);
  EXPECT_EQ(StoreText(list.store), "store    1.5 MB of 2.0 GB allowed\n");
  EXPECT_EQ(StoreText({999, 0}), "store    999 B\n");
}

}  // namespace
}  // namespace cairn::cli
