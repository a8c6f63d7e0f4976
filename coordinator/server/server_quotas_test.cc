// What one key may have, and until when.
#include <gtest/gtest.h>

#include <ctime>
#include <string>

#include "coordinator/server/testing/rights_fixture.h"

namespace cairn::coordinator {
namespace {

using wire::RefusalKind;

class Quotas : public RightsFixture {
 protected:
  // Of ann, who submits; bob and the chief may do as much as they like.
  void LimitAnn(const std::string& limits) {
    Allow(submitter_ + " submitter," + limits + " ann\n" + other_ + " submitter bob\n" + worker_ +
          " admin chief\n" + viewer_ + " viewer\n");
  }
  wire::Message Named(const std::string& name) {
    proto::Job job = fixture_.MakeJob();
    job.set_seed(++seed_);  // another one each time
    job.set_name(name);
    return fixture_.Submission(job, false);
  }
  wire::Reply Submit(const std::string& user, const std::string& name = "toy") {
    EXPECT_TRUE(fixture_.Upload(TextBlob("the log"), "peer of " + user, user).ok());
    return Ask(user, Named(name)).reply();
  }
  std::size_t JobCount() const { return fixture_.server->core().Jobs().size(); }

  std::uint64_t seed_ = 0;
};

TEST_F(Quotas, ASubmitterHasSoManyJobsThatHaveNotEndedAndNoMore) {
  LimitAnn("jobs=2");
  const std::string first = Submit(submitter_).jobs(0).id();
  ASSERT_TRUE(Submit(submitter_).ok());
  const wire::Reply third = Submit(submitter_);
  EXPECT_FALSE(third.ok());
  EXPECT_TRUE(third.unable()) << "it is not the job that is wrong";
  EXPECT_NE(third.message().find("has 2 jobs that have not ended, the most that may be (jobs=2)"),
            std::string::npos)
      << third.message();
  EXPECT_EQ(JobCount(), 2u);
  EXPECT_EQ(Count(RefusalKind::kQuota), 1u);
  EXPECT_TRUE(Submit(other_).ok()) << "another's are another's";
  const wire::Envelope cancelled = Ask(submitter_, Query("cancel", first));
  ASSERT_TRUE(cancelled.reply().ok()) << cancelled.ShortDebugString();
  EXPECT_TRUE(Submit(submitter_).ok());
}

// What has failed has ended: a retry is one more, too.
TEST_F(Quotas, ARetryCountsAsAJob) {
  LimitAnn("jobs=1");
  const std::string first = Submit(submitter_).jobs(0).id();
  fixture_.transport.swallow = [this](const wire::Assign& assign) {
    wire::Message failed;
    *failed.envelope.mutable_failed()->mutable_key() = assign.key();
    failed.envelope.mutable_failed()->set_input_error(true);
    fixture_.transport.Come("w", failed, worker_);
    return true;
  };
  Allow(submitter_ + " submitter,jobs=1 ann\n" + worker_ + " worker,admin chief\n");
  Join("w", worker_, 1);
  fixture_.Until([&] { return fixture_.State(first) == "failed"; });
  fixture_.transport.swallow = [](const wire::Assign&) { return true; };
  ASSERT_TRUE(Submit(submitter_).ok());
  EXPECT_NE(Ask(submitter_, Query("retry", first)).reply().message().find("jobs=1"), std::string::npos);
  EXPECT_EQ(fixture_.State(first), "failed");
}

TEST_F(Quotas, AnUploadThatIsOverTheInputsOfAKeyDoesNotBegin) {
  LimitAnn("inputs-mb=1");
  const Hash big = TextBlob("big").hash;
  const wire::Envelope refused = Ask(submitter_, fixture_.Offer(big, 1'000'001));
  ASSERT_TRUE(refused.has_reply()) << refused.ShortDebugString();
  EXPECT_NE(refused.reply().message().find("inputs-mb=1"), std::string::npos) << refused.reply().message();
  EXPECT_EQ(fixture_.server->uploads().size(), 0u);
  ASSERT_TRUE(Ask(submitter_, fixture_.Offer(big, 900'000)).has_credit());
  const std::string peer = "another of hers";
  fixture_.transport.Come(peer, fixture_.Offer(TextBlob("other").hash, 200'000), submitter_);
  std::optional<wire::Reply> reply;
  fixture_.Until([&] { return (reply = fixture_.TakeReply(peer)).has_value(); });
  EXPECT_FALSE(reply->ok()) << "what is on its way over another connection counts";
  EXPECT_TRUE(Ask(other_, fixture_.Offer(TextBlob("other").hash, 200'000)).has_credit());
}

TEST_F(Quotas, TheInputsOfJobsThatAreNotDoneCount) {
  LimitAnn("inputs-mb=1");
  Blob blob;
  blob.Put("text", Array::Text(std::string(600'000, 'x')));
  const wire::NamedBlob large = wire::NameBlob(std::make_shared<const Blob>(blob));
  ASSERT_TRUE(fixture_.Upload(large, "peer of " + submitter_, submitter_).ok());
  proto::Job job = fixture_.MakeJob();
  (*job.mutable_input_blobs())["log"] = large.hash.Binary();
  const wire::Reply first = Ask(submitter_, fixture_.Submission(job, false)).reply();
  ASSERT_TRUE(first.ok()) << first.message();
  const Hash other = TextBlob("other").hash;
  EXPECT_FALSE(Ask(submitter_, fixture_.Offer(other, 500'000)).reply().ok());
  job.set_seed(7);
  EXPECT_TRUE(Ask(submitter_, fixture_.Submission(job, false)).reply().ok())
      << "the same input takes no more";
  for (const wire::JobInfo& info : fixture_.server->core().Jobs())
    ASSERT_TRUE(Ask(submitter_, Query("cancel", info.id())).reply().ok());
  EXPECT_TRUE(Ask(submitter_, fixture_.Offer(other, 500'000)).has_credit());
}

TEST_F(Quotas, AJobsTasksTakeNoMoreMemoryThanItsKeyMay) {
  LimitAnn("memory-mb=100");
  const std::string job = Submit(submitter_).jobs(0).id();
  EXPECT_EQ(fixture_.server->core().FindJob(job)->spec.task_memory_mb(), 100u);
  wire::Message greedy = Named("greedy");
  greedy.envelope.mutable_submit()->mutable_job()->set_task_memory_mb(101);
  const wire::Reply refused = Ask(submitter_, greedy).reply();
  EXPECT_NE(refused.message().find("task_memory_mb is 101, the most that may be (memory-mb=100)"),
            std::string::npos)
      << refused.message();
  EXPECT_FALSE(refused.unable()) << "that is wrong however often it is tried";
  greedy.envelope.mutable_submit()->mutable_job()->set_task_memory_mb(50);
  EXPECT_EQ(
      fixture_.server->core().FindJob(Ask(submitter_, greedy).reply().jobs(0).id())->spec.task_memory_mb(),
      50u);
}

// Ten seconds' worth at once; heartbeats, answers and pieces of uploads are no requests.
TEST_F(Quotas, WhoAsksTooOftenIsToldSoAndNobodyElseIs) {
  LimitAnn("requests=1");
  int refused = 0;
  for (int i = 0; i < 40; ++i) {
    const wire::Reply reply = Ask(submitter_, Query("status", "")).reply();
    if (reply.ok()) continue;
    ++refused;
    EXPECT_NE(reply.message().find("asks more than 1 times a second"), std::string::npos) << reply.message();
    EXPECT_TRUE(reply.unable());
    EXPECT_GT(reply.again_s(), 0);
    EXPECT_LE(reply.again_s(), 1);
  }
  EXPECT_GE(refused, 1);
  EXPECT_LE(refused, 30);
  EXPECT_EQ(Count(RefusalKind::kQuota), static_cast<std::uint64_t>(refused));
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(Ask(other_, Query("status", "")).reply().ok());
  LimitAnn("jobs=9");
  EXPECT_TRUE(Ask(submitter_, Query("status", "")).reply().ok()) << "a list that is changed holds at once";
}

TEST_F(Quotas, WhatTheListDoesNotSayIsTheServicesDefaultButForAdministrators) {
  fixture_.key_limits.jobs = 1;
  fixture_.Start();
  LimitAnn("jobs=2");
  ASSERT_TRUE(Submit(submitter_).ok());
  EXPECT_TRUE(Submit(submitter_).ok()) << "its own limit holds";
  ASSERT_TRUE(Submit(other_).ok());
  EXPECT_FALSE(Submit(other_).ok());
  ASSERT_TRUE(Submit(worker_).ok());
  EXPECT_TRUE(Submit(worker_).ok());
}

TEST_F(Quotas, AKeyWhoseTimeIsOverIsRefusedAndItsWorkersGo) {
  Allow(submitter_ + " submitter,until=2001-01-01 ann\n" + viewer_ + " viewer\n" + worker_ +
        " worker,until=" + wire::UntilText(::time(nullptr) + 2) + " desk\n" + other_ + " worker\n");
  ExpectRefused(submitter_, Query("status", ""), RefusalKind::kRevoked);
  fixture_.transport.swallow = [](const wire::Assign&) { return true; };
  Join("w", worker_, 1);
  fixture_.Submit();
  fixture_.Until([&] { return fixture_.transport.assigned > 0; });
  const wire::Reply soon = Ask(viewer_, Query("status", "")).reply();
  EXPECT_NE(soon.warning().find("the key of desk (" + wire::ShortKey(worker_) + ") is good until 2"),
            std::string::npos)
      << soon.warning();
  fixture_.Until([&] { return !Connected("w"); });
  EXPECT_EQ(Count(RefusalKind::kRevoked), 2u);
  EXPECT_TRUE(fixture_.server->core().Find("a")->reason().empty()) << "nobody is blamed";
  EXPECT_EQ(Ask(viewer_, Query("status", "")).reply().warning(), "") << "what is over is over";
}

TEST_F(Quotas, OfManyKeysWhoseTimeEndsAFewAreNamed) {
  std::string lines = viewer_ + " viewer\n";
  const std::string soon = wire::UntilText(::time(nullptr) + 86'400),
                    late = wire::UntilText(::time(nullptr) + 30 * 86'400);
  for (int i = 0; i < 9; ++i)
    lines += wire::GenerateKeyPair().public_key + " worker,until=" + (i < 8 ? soon : late) + " w\n";
  Allow(lines);
  const std::string warning = Ask(viewer_, Query("status", "")).reply().warning();
  EXPECT_TRUE(warning.ends_with(", and 5 more")) << warning;
}

}  // namespace
}  // namespace cairn::coordinator
