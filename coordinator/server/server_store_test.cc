// What a store may take, and for how long jobs stay in it.
#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/served_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLimit_bytes = 1'000'000;

class StoreLimit : public ::testing::Test {
 protected:
  void Start() {
    fixture_.store_limit_bytes = kLimit_bytes;
    fixture_.Start();
    fixture_.transport.ComeWorker("w");
  }
  fs::path Filler() const { return fixture_.temp.path() / "store" / "blobs" / "filler"; }
  void Fill() const {
    std::ofstream(Filler()) << "x";
    fs::resize_file(Filler(), kLimit_bytes);
  }
  ServerFixture fixture_;
};

TEST_F(StoreLimit, AJobThatWouldGoOverItIsPausedWithTheReasonAndResumeGoesOn) {
  Fill();
  Start();
  fixture_.Submit();
  fixture_.Until([&] { return fixture_.State() == "paused"; });
  const std::string reason = fixture_.server->core().Find("a")->reason();
  EXPECT_NE(reason.find("of at most 1.0 MB (--store-gb)"), std::string::npos) << reason;
  fixture_.server->GoOn("a");
  fixture_.Until([&] { return fixture_.State() == "paused"; });
  fs::remove(Filler());
  fixture_.server->GoOn("a");
  fixture_.Until([&] { return fixture_.State() == "done"; });
}

TEST_F(StoreLimit, InAFullStoreAJobCanStillBeCancelledAndDeleted) {
  Fill();
  Start();
  fixture_.Submit();
  fixture_.Until([&] { return fixture_.State() == "paused"; });
  wire::Message cancel, remove;
  cancel.envelope.mutable_query()->set_job("a");
  remove.envelope.mutable_query()->set_job("a");
  cancel.envelope.mutable_query()->set_action("cancel");
  remove.envelope.mutable_query()->set_action("delete");
  const wire::Reply cancelled = fixture_.Ask(cancel);
  EXPECT_TRUE(cancelled.ok()) << cancelled.message();
  EXPECT_EQ(fixture_.State(), "cancelled");
  EXPECT_TRUE(fixture_.Ask(remove).ok());
}

TEST_F(StoreLimit, ASubmissionThatDoesNotFitIsRefusedAndCounted) {
  Fill();
  Start();
  const wire::Reply refused = fixture_.Upload(TextBlob("the log"));
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("more do not fit"), std::string::npos) << refused.message();
  EXPECT_EQ(fixture_.server->refusals().count(wire::RefusalKind::kStore), 1u);
  EXPECT_TRUE(fixture_.server->core().Jobs().empty());
  fs::remove(Filler());
  Start();
  EXPECT_TRUE(fixture_.Ask(fixture_.Submission(fixture_.MakeJob())).ok());
}

TEST_F(StoreLimit, TheStatusSaysWhatTheStoreHoldsAndMayHold) {
  Fill();
  Start();
  wire::Message question;
  question.envelope.mutable_query();
  const wire::Reply reply = fixture_.Ask(question);
  EXPECT_GE(reply.store_bytes(), kLimit_bytes);
  EXPECT_LT(reply.store_bytes(), kLimit_bytes + 100'000);
  EXPECT_EQ(reply.store_limit_bytes(), kLimit_bytes);
}

TEST(Retention, AJobThatEndedLongAgoGoesWithItsResultsOverRestarts) {
  constexpr double kDay_s = 86400;
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return fixture.State() == "done"; });
  fixture.server->Shut(1);
  const fs::path results = fixture.temp.path() / "results" / "a";
  const fs::path served = fixture.temp.path() / "store" / "served";
  fixture.server.reset();
  ASSERT_TRUE(fs::exists(served)) << "so that a restart does not begin anew";
  ASSERT_TRUE(fs::exists(results / "stage0.h5"));

  fixture.keep_s = 2 * kDay_s;
  ASSERT_TRUE(WriteServed(served, 1.9 * kDay_s).ok());
  fixture.Start();
  for (int i = 0; i < 300; ++i) fixture.server->Step(0.001);
  EXPECT_EQ(fixture.State(), "done");
  fixture.server.reset();

  ASSERT_TRUE(WriteServed(served, 2.1 * kDay_s).ok());
  fixture.Start();
  fixture.Until([&] { return fixture.State().empty(); });
  EXPECT_TRUE(fixture.Logged("a is deleted: it ended 2.1 days ago"));
  fixture.Until([&] { return !fs::exists(results); });
  fixture.Start();
  EXPECT_EQ(fixture.State(), "") << "it does not come back";
}

}  // namespace
}  // namespace cairn::coordinator
