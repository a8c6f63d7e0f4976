// Whose job is whose, and who may command it.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "coordinator/server/testing/rights_fixture.h"

namespace cairn::coordinator {
namespace {

using wire::RefusalKind;

class Owners : public RightsFixture {
 protected:
  Owners() { AllowAll(); }
  void AllowAll(const std::string& more = "") {
    Allow(submitter_ + " submitter ann\n" + other_ + " submitter bob\n" + worker_ + " admin chief\n" +
          viewer_ + " viewer\n" + more);
  }
  // A job of ann's.
  std::string AJob() {
    Bring();
    return Ask(submitter_, Submission()).reply().jobs(0).id();
  }
};

const std::vector<std::string> kChanges = {"pause", "resume", "priority", "cancel", "retry", "delete"};

TEST_F(Owners, NobodyButItsOwnerAndAnAdministratorCommandsAJob) {
  const std::string job = AJob();
  EXPECT_EQ(fixture_.server->core().Find(job)->owner(), "ann");
  const std::uint64_t before = Count(RefusalKind::kRight);
  for (const std::string& change : kChanges) {
    const wire::Reply reply = Ask(other_, Query(change, job)).reply();
    EXPECT_FALSE(reply.ok()) << change;
    EXPECT_NE(
        reply.message().find("cannot " + change + " " + job + ": it belongs to ann, and the key of bob"),
        std::string::npos)
        << reply.message();
    EXPECT_EQ(fixture_.State(job), "queued") << change;
  }
  EXPECT_EQ(Count(RefusalKind::kRight), before + kChanges.size());
  EXPECT_EQ(Ask(submitter_, Query("pause", job)).reply().jobs(0).state(), "paused");
  EXPECT_EQ(Ask(worker_, Query("cancel", job)).reply().jobs(0).state(), "cancelled");
  EXPECT_EQ(Ask(submitter_, Query("delete", job)).reply().jobs(0).state(), "deleted");
}

TEST_F(Owners, EverybodySeesWhoseAJobIsAndWhetherItIsHis) {
  const std::string job = AJob();
  struct Sees {
    std::string user;
    bool foreign, may_submit = true;
  };
  for (const Sees& sees :
       {Sees{submitter_, false}, Sees{other_, true}, Sees{worker_, false}, Sees{viewer_, true, false}})
    for (const std::string& asked : {job, std::string()}) {
      const wire::Reply reply = Ask(sees.user, Query("status", asked)).reply();
      ASSERT_EQ(reply.jobs_size(), 1);
      EXPECT_EQ(reply.jobs(0).owner(), "ann");
      EXPECT_EQ(reply.jobs(0).foreign(), sees.foreign);
      EXPECT_EQ(reply.may_submit(), sees.may_submit) << "or he is offered what he may not do";
      EXPECT_EQ(Ask(sees.user, Query("logs", job)).reply().jobs(0).foreign(), sees.foreign);
    }
  EXPECT_TRUE(Ask(other_, Query("logs", job)).reply().ok());
  EXPECT_TRUE(Ask(viewer_, Query("results", job)).reply().ok());
  EXPECT_TRUE(Ask(viewer_, Query("so_far", job)).reply().ok());
}

// A log may show what its owner shows nobody.
TEST_F(Owners, AJobsInputsAreItsOwners) {
  const std::string job = AJob();
  EXPECT_TRUE(Ask(submitter_, Query("inputs", job)).reply().ok());
  EXPECT_TRUE(Ask(worker_, Query("inputs", job)).reply().ok()) << "an administrator's";
  const wire::Reply refused = Ask(other_, Query("inputs", job)).reply();
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("cannot hand out the inputs of " + job + ": it belongs to ann"),
            std::string::npos)
      << refused.message();
  EXPECT_FALSE(Ask(viewer_, Query("inputs", job)).reply().ok());
}

// Its hash is in each result, which everybody reads. What he does bring is not kept twice.
TEST_F(Owners, NobodyGetsAnothersInputByItsHash) {
  const std::string job = AJob();
  const wire::NamedBlob log = TextBlob("the log");
  wire::Message theft = Submission();
  theft.envelope.mutable_submit()->mutable_job()->set_name("mine");
  theft.envelope.mutable_submit()->mutable_job()->mutable_stages(0)->set_name("other");
  wire::Message have;
  have.envelope.mutable_have()->add_hashes(log.hash.Binary());
  const auto expect_nothing = [&] {
    EXPECT_EQ(Ask(other_, have).reply().missing_size(), 1);
    const wire::Reply refused = Ask(other_, theft).reply();
    EXPECT_FALSE(refused.ok());
    ASSERT_EQ(refused.missing_size(), 1) << refused.message();
    EXPECT_EQ(refused.missing(0), log.hash.Binary());
    const std::uint64_t bytes = flat_testing::Flat(*log.blob).size();
    const wire::Envelope offered = Ask(other_, ServerFixture::Offer(log.hash, bytes));
    EXPECT_TRUE(offered.has_credit()) << "the bytes are wanted: " << offered.ShortDebugString();
    fixture_.transport.Come("peer of " + other_, ServerFixture::Piece(log.hash, 7, "none of it"), other_);
    fixture_.Until([&] { return fixture_.server->uploads().size() == 0; });
  };
  expect_nothing();
  EXPECT_EQ(Ask(submitter_, have).reply().missing_size(), 0);
  EXPECT_EQ(Ask(worker_, have).reply().missing_size(), 0) << "an administrator's";
  fixture_.Until([&] { return !fixture_.server->core().HasUnsaved(); });
  fixture_.Start();
  expect_nothing();
  EXPECT_EQ(Ask(submitter_, have).reply().missing_size(), 0);
  ASSERT_TRUE(fixture_.Upload(log, "peer of " + other_, other_).ok());
  EXPECT_EQ(Ask(other_, have).reply().missing_size(), 0);
  const wire::Reply taken = Ask(other_, theft).reply();
  ASSERT_TRUE(taken.ok()) << taken.message();
  EXPECT_TRUE(Ask(other_, Query("inputs", taken.jobs(0).id())).reply().ok());
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(fixture_.folder->Blobs()))
    ++files;
  EXPECT_EQ(files, 1u) << "the same blob twice";
  EXPECT_TRUE(Ask(submitter_, Query("cancel", job)).reply().ok());
  EXPECT_EQ(Ask(other_, have).reply().missing_size(), 0) << "another's job needs it";
}

TEST_F(Owners, OwnersOutliveARestartAndFollowTheNameToANewKey) {
  const std::string job = AJob();
  fixture_.Until([&] { return !fixture_.server->core().HasUnsaved(); });
  fixture_.Start();
  EXPECT_EQ(fixture_.server->core().Find(job)->owner(), "ann");
  EXPECT_FALSE(Ask(other_, Query("pause", job)).reply().ok());
  AllowAll(stranger_ + " submitter ann\n");
  EXPECT_TRUE(Ask(stranger_, Query("pause", job)).reply().ok()) << "the new key of who was given one";
  Allow(submitter_ + " submitter bob\n" + stranger_ + " submitter ann\n");
  EXPECT_FALSE(Ask(submitter_, Query("resume", job)).reply().ok()) << "a key that is called otherwise now";
}

// Such as are from before there were owners: else whoever came first might end what nobody knows whose it is.
TEST_F(Owners, AJobWithoutAnOwnerIsAnAdministratorsAlone) {
  fixture_.Submit();
  const wire::Reply reply = Ask(submitter_, Query("cancel")).reply();
  EXPECT_NE(reply.message().find("it has no owner"), std::string::npos) << reply.message();
  EXPECT_EQ(fixture_.State(), "queued");
  EXPECT_EQ(Ask(worker_, Query("cancel")).reply().jobs(0).state(), "cancelled");
}

TEST_F(Owners, AKeyWithoutANameOwnsItsJobsItself) {
  Allow(submitter_ + " submitter\n" + other_ + " submitter\n");
  const std::string job = AJob();
  EXPECT_EQ(fixture_.server->core().Find(job)->owner(), submitter_);
  const wire::Reply refused = Ask(other_, Query("cancel", job)).reply();
  EXPECT_EQ(refused.message().find(submitter_), std::string::npos) << "the whole key is shown";
  EXPECT_TRUE(Ask(submitter_, Query("cancel", job)).reply().ok());
}

// The same job of the same inputs is computed once: it stays whose it was.
TEST_F(Owners, WhatAnotherHasSubmittedIsKnownAndStaysHis) {
  const std::string job = AJob();
  const wire::Reply again = Ask(other_, Submission()).reply();
  EXPECT_TRUE(again.known());
  EXPECT_EQ(again.jobs(0).id(), job);
  EXPECT_EQ(again.jobs(0).owner(), "ann");
  EXPECT_TRUE(again.jobs(0).foreign()) << "he is told";
  const wire::Reply hers = Ask(submitter_, Submission()).reply();
  EXPECT_TRUE(hers.known());
  EXPECT_FALSE(hers.jobs(0).foreign());
}

TEST_F(Owners, WhoPausesAnothersJobIsNamed) {
  const std::string job = AJob();
  const wire::JobInfo paused = Ask(worker_, Query("pause", job)).reply().jobs(0);
  EXPECT_EQ(paused.state(), "paused");
  EXPECT_EQ(paused.reason(), "paused by chief (" + wire::ShortKey(worker_) + ")");
  EXPECT_TRUE(Ask(submitter_, Query("resume", job)).reply().ok());
  EXPECT_EQ(Ask(submitter_, Query("pause", job)).reply().jobs(0).reason(), "paused by its owner");
}

// He could neither resume nor cancel it.
TEST_F(Owners, WhatAnotherHasPausedHoldsNobodysOwn) {
  const std::string job = AJob();
  ASSERT_EQ(Ask(submitter_, Query("pause", job)).reply().jobs(0).state(), "paused");
  ASSERT_TRUE(fixture_.Upload(TextBlob("the log"), "peer of " + other_, other_).ok());
  const wire::Reply own = Ask(other_, Submission()).reply();
  ASSERT_TRUE(own.ok()) << own.message();
  EXPECT_FALSE(own.known());
  EXPECT_NE(own.jobs(0).id(), job);
  EXPECT_EQ(own.jobs(0).owner(), "bob");
  EXPECT_FALSE(own.jobs(0).foreign());
  EXPECT_EQ(Ask(submitter_, Submission()).reply().jobs(0).id(), job) << "her own is known again, paused";
  EXPECT_EQ(Ask(other_, Submission()).reply().jobs(0).id(), own.jobs(0).id());
  EXPECT_EQ(Ask(worker_, Submission()).reply().jobs(0).id(), job) << "an administrator may resume it";
}

TEST(OwnersWithoutKeys, AreTheUserWhoseSocketItIsAndNobodyIsRefused) {
  ServerFixture fixture;
  const wire::Reply reply = fixture.Ask(fixture.Submission(fixture.MakeJob()));
  ASSERT_TRUE(reply.ok()) << reply.message();
  EXPECT_FALSE(reply.jobs(0).owner().empty());
  fixture.Submit("b");
  wire::Message cancel;
  cancel.envelope.mutable_query()->set_action("cancel");
  for (const std::string& job : {reply.jobs(0).id(), std::string("b")}) {
    cancel.envelope.mutable_query()->set_job(job);
    EXPECT_TRUE(fixture.Ask(cancel).ok()) << job;
  }
}

}  // namespace
}  // namespace cairn::coordinator
