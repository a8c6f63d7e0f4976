// What clients ask of a service.
#include <gtest/gtest.h>

#include "coordinator/hub_bench.h"

namespace cairn::coordinator {
namespace {

wire::Message Submission(const proto::Job& job, bool with_blob) {
  wire::Message message;
  *message.envelope.mutable_submit()->mutable_job() = job;
  if (with_blob) message.blobs.push_back(TextBlob("the log"));
  return message;
}

wire::Message Query(const std::string& job, const std::string& action) {
  wire::Message message;
  message.envelope.mutable_query()->set_job(job);
  message.envelope.mutable_query()->set_action(action);
  return message;
}

TEST(HubRequests, HaveNamesWhatIsMissing) {
  HubBench bench;
  bench.Submit();
  wire::Message have;
  have.envelope.mutable_have()->add_hashes(TextBlob("the log").hash.Binary());
  have.envelope.mutable_have()->add_hashes(TextBlob("another").hash.Binary());
  const wire::Reply reply = bench.Ask(have);
  EXPECT_TRUE(reply.ok());
  ASSERT_EQ(reply.missing_size(), 1);
  EXPECT_EQ(reply.missing(0), TextBlob("another").hash.Binary());
}

TEST(HubRequests, ASubmittedJobIsDurableWhenItIsAnswered) {
  HubBench bench;
  const wire::Reply reply = bench.Ask(Submission(bench.MakeJob(), true));
  ASSERT_TRUE(reply.ok()) << reply.message();
  EXPECT_EQ(reply.jobs(0).id(), "1-toy");
  EXPECT_EQ(reply.jobs(0).state(), "queued");
  EXPECT_EQ(bench.folder->CheckpointNumbers("1-toy").size(), 1u);
}

TEST(HubRequests, TheSameJobTwiceIsOneAndAnotherIsAnother) {
  HubBench bench;
  EXPECT_EQ(bench.Ask(Submission(bench.MakeJob(), true)).jobs(0).id(), "1-toy");
  EXPECT_EQ(bench.Ask(Submission(bench.MakeJob(), false)).jobs(0).id(), "1-toy");
  EXPECT_EQ(bench.Ask(Submission(bench.MakeJob(2), false)).jobs(0).id(), "2-toy");
}

TEST(HubRequests, ASubmissionWithoutItsInputsOrWithABadChainIsRefused) {
  HubBench bench;
  EXPECT_NE(bench.Ask(Submission(bench.MakeJob(), false)).message().find("'log' is missing"),
            std::string::npos);
  proto::Job job = bench.MakeJob();
  job.mutable_stages(0)->set_name("../../etc");
  const wire::Reply reply = bench.Ask(Submission(job, true));
  EXPECT_FALSE(reply.ok());
  EXPECT_TRUE(bench.hub->core().Jobs().empty());
}

TEST(HubRequests, ResultsComeWithTheirNamesAndProvenance) {
  HubBench bench;
  bench.transport.ComeWorker("w");
  bench.Submit("a", 2);
  bench.Until([&] { return bench.State() == "done"; });
  const wire::Reply reply = bench.Ask(Query("a", "results"));
  ASSERT_EQ(reply.names_size(), 2);
  EXPECT_EQ(reply.names(1), "stage1");
  ASSERT_EQ(bench.last_blobs.size(), 2u);
  EXPECT_EQ(bench.last_blobs[1].blob->Text("provenance/kind"), "toy");
}

TEST(HubRequests, StatusListCancelAndResume) {
  HubBench bench;
  bench.Submit("a");
  bench.Submit("b", 2);
  EXPECT_EQ(bench.Ask(Query("", "")).jobs_size(), 2);
  EXPECT_EQ(bench.Ask(Query("b", "status")).jobs(0).stages(), 2u);
  EXPECT_EQ(bench.Ask(Query("a", "cancel")).jobs(0).state(), "cancelled");
  EXPECT_EQ(bench.Ask(Query("a", "resume")).jobs(0).state(), "queued");
}

TEST(HubRequests, WhatMakesNoSenseIsRefusedWithTheReason) {
  HubBench bench;
  EXPECT_NE(bench.Ask(Query("nobody", "status")).message().find("'nobody'"), std::string::npos);
  EXPECT_NE(bench.Ask(Query("", "cancel")).message().find("which job"), std::string::npos);
  EXPECT_NE(bench.Ask(Query("", "explode")).message().find("'explode'"), std::string::npos);
}

TEST(HubRequests, NumbersOfJobsAreNotUsedAgainAfterARestart) {
  HubBench bench;
  EXPECT_EQ(bench.Ask(Submission(bench.MakeJob(), true)).jobs(0).id(), "1-toy");
  bench.Start();
  EXPECT_EQ(bench.Ask(Submission(bench.MakeJob(2), true)).jobs(0).id(), "2-toy");
}

}  // namespace
}  // namespace cairn::coordinator
