// What a submission has to know, whatever became of the jobs, and that it costs no more the more there are.
#include "coordinator/server/job_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "coordinator/core/testing/test_job.h"
#include "coordinator/server/testing/rights_fixture.h"
#include "schema/allocations_testing.h"

namespace cairn::coordinator {
namespace {

Job JobOf(std::uint64_t order, const std::string& owner, const proto::Job& spec) {
  Job job;
  job.id = std::to_string(order) + "-test";
  job.order = order;
  job.owner = owner;
  job.SetSpec(spec);
  return job;
}

std::string ServingIn(const JobIndex& index, const Job& job) {
  const std::string* id =
      index.Serving(job.hash, [&job](const std::string& owner) { return owner == job.owner; });
  return id == nullptr ? "" : *id;
}

TEST(JobIndex, AnothersPausedJobServesNobodyButWhoMayResumeIt) {
  JobIndex index([](const Hash&) { return 0; });
  Job anns = JobOf(1, "ann", TestJob()), bobs = JobOf(2, "bob", TestJob());
  anns.state = proto::JOB_PAUSED;
  index.File(anns.id, &anns);
  EXPECT_EQ(ServingIn(index, anns), anns.id);
  EXPECT_EQ(ServingIn(index, bobs), "");
  anns.state = proto::JOB_RUNNING;
  index.File(anns.id, &anns);
  EXPECT_EQ(ServingIn(index, bobs), anns.id) << "it is computed once";
  index.File(bobs.id, &bobs);
  EXPECT_EQ(ServingIn(index, bobs), bobs.id) << "his own comes first";
}

TEST(JobIndex, TheFirstThatIsNotInVainServes) {
  JobIndex index([](const Hash&) { return 0; });
  Job first = JobOf(1, "ann", TestJob()), second = JobOf(2, "bob", TestJob());
  index.File(second.id, &second);
  EXPECT_EQ(ServingIn(index, first), second.id);
  index.File(first.id, &first);
  EXPECT_EQ(ServingIn(index, first), first.id);
  first.state = proto::JOB_FAILED;
  index.File(first.id, &first);
  EXPECT_EQ(ServingIn(index, first), second.id);
  second.state = proto::JOB_DONE;
  index.File(second.id, &second);
  EXPECT_EQ(ServingIn(index, first), second.id);
  second.leaving = true;
  index.File(second.id, &second);
  EXPECT_EQ(ServingIn(index, first), "");
  first.state = proto::JOB_RUNNING;
  index.File(first.id, &first);
  EXPECT_EQ(ServingIn(index, first), first.id);
  index.File(first.id, nullptr);
  EXPECT_EQ(ServingIn(index, first), "");
}

TEST(JobIndex, WhatAnOwnerHasFollowsHisJobs) {
  JobIndex index([](const Hash& input) { return input == H(5) ? 500 : 10; });
  Job one = JobOf(1, "ann", TestJob(1, H(5))), same = JobOf(2, "ann", TestJob(2, H(5)));
  Job other = JobOf(3, "ann", TestJob(1, H(6))), bobs = JobOf(4, "bob", TestJob(1, H(5)));
  for (const Job* job : {&one, &same, &other, &bobs, &one}) index.File(job->id, job);
  EXPECT_EQ(index.Of("ann").not_ended, 3u);
  EXPECT_EQ(index.Of("ann").input_bytes, 510u) << "what two read is there once";
  EXPECT_EQ(index.Of("bob").input_bytes, 500u);
  EXPECT_EQ(index.running(), 4u);
  one.state = proto::JOB_DONE;
  other.state = proto::JOB_FAILED;
  for (const Job* job : {&one, &other}) index.File(job->id, job);
  EXPECT_EQ(index.Of("ann").not_ended, 1u);
  EXPECT_EQ(index.Of("ann").input_bytes, 510u) << "one that has failed may be retried";
  EXPECT_EQ(index.running(), 2u);
  same.state = proto::JOB_PAUSED;
  index.File(same.id, &same);
  EXPECT_EQ(index.Of("ann").not_ended, 1u);
  EXPECT_EQ(index.running(), 1u);
  index.File(other.id, nullptr);
  index.File(same.id, nullptr);
  EXPECT_EQ(index.Of("ann").input_bytes, 0u);
  EXPECT_EQ(index.Of("nobody").not_ended, 0u);
}

class ManyJobs : public RightsFixture {
 protected:
  // How often the event loop allocates memory to take a submission.
  long AllocationsOfOne() {
    proto::Job job = fixture_.MakeJob();
    job.set_seed(++seed_);
    wire::Message message = fixture_.Submission(job, false);
    fixture_.transport.Come("desk", std::move(message), submitter_);
    const long before = Allocations();
    fixture_.server->Step(0);
    const long allocations = Allocations() - before;
    std::optional<wire::Reply> reply;
    fixture_.Until([&] { return (reply = fixture_.TakeReply("desk")).has_value(); });
    EXPECT_TRUE(reply->ok()) << reply->message();
    EXPECT_EQ(reply->jobs(0).id(), std::to_string(seed_) + "-toy");
    return allocations;
  }
  // Of a few, for now and then there is a tick.
  long LeastOf(int count) {
    long least = AllocationsOfOne();
    for (int i = 1; i < count; ++i) least = std::min(least, AllocationsOfOne());
    return least;
  }

  std::uint64_t seed_ = 0;
};

TEST_F(ManyJobs, ASubmissionTakesNoMoreTheMoreThereAre) {
  Allow(submitter_ + " submitter,jobs=1000,inputs-mb=1000 ann\n");
  ASSERT_TRUE(fixture_.Upload(TextBlob("the log"), "desk", submitter_).ok());
  const long with_few = LeastOf(5);
  for (int i = 0; i < 100; ++i) AllocationsOfOne();
  EXPECT_LE(LeastOf(5), with_few + with_few / 10);
}

}  // namespace
}  // namespace cairn::coordinator
