#include "coordinator/cli/job_text.h"

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

TEST(JobText, JsonHoldsTheSame) {
  const nlohmann::json json = nlohmann::json::parse(JobJson(AJobWithFailures()));
  EXPECT_EQ(json.at("retries"), 7);
  ASSERT_EQ(json.at("failures").size(), 1u);
  EXPECT_EQ(json.at("id"), "1-museum");
}

TEST(JobText, SaysWhatTheStoreHoldsAndMayHold) {
  coordinator::JobList list;
  list.store = {1'500'000, 2'000'000'000};
  const nlohmann::json json = nlohmann::json::parse(JobsJson(list));
  EXPECT_EQ(json.at("store").at("bytes"), 1'500'000);
  EXPECT_EQ(json.at("store").at("limit_bytes"), 2'000'000'000);
  EXPECT_EQ(StoreText(list.store), "store 1.5 MB of 2.0 GB allowed\n");
  EXPECT_EQ(StoreText({999, 0}), "store 999 B\n");
}

}  // namespace
}  // namespace cairn::cli
