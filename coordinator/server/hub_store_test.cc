// What a store may take, and for how long jobs stay in it.
#include <fstream>

#include "coordinator/server/hub_bench.h"
#include "coordinator/store/served_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLimit_bytes = 1'000'000;

class StoreLimit : public ::testing::Test {
 protected:
  void Start() {
    bench_.store_limit_bytes = kLimit_bytes;
    bench_.Start();
    bench_.transport.ComeWorker("w");
  }
  fs::path Filler() const { return bench_.temp.path() / "store" / "blobs" / "filler"; }
  void Fill() const {
    std::ofstream(Filler()) << "x";
    fs::resize_file(Filler(), kLimit_bytes);
  }
  HubBench bench_;
};

TEST_F(StoreLimit, AJobThatWouldGoOverItIsPausedWithTheReasonAndResumeGoesOn) {
  Fill();
  Start();
  bench_.Submit();
  bench_.Until([&] { return bench_.State() == "paused"; });
  const std::string reason = bench_.hub->core().Find("a")->reason();
  EXPECT_NE(reason.find("of at most 1.0 MB (--store-gb)"), std::string::npos) << reason;
  bench_.hub->GoOn("a");
  bench_.Until([&] { return bench_.State() == "paused"; });
  fs::remove(Filler());
  bench_.hub->GoOn("a");
  bench_.Until([&] { return bench_.State() == "done"; });
}

TEST_F(StoreLimit, InAFullStoreAJobCanStillBeCancelledAndDeleted) {
  Fill();
  Start();
  bench_.Submit();
  bench_.Until([&] { return bench_.State() == "paused"; });
  wire::Message cancel, remove;
  cancel.envelope.mutable_query()->set_job("a");
  remove.envelope.mutable_query()->set_job("a");
  cancel.envelope.mutable_query()->set_action("cancel");
  remove.envelope.mutable_query()->set_action("delete");
  const wire::Reply cancelled = bench_.Ask(cancel);
  EXPECT_TRUE(cancelled.ok()) << cancelled.message();
  EXPECT_EQ(bench_.State(), "cancelled");
  EXPECT_TRUE(bench_.Ask(remove).ok());
}

TEST_F(StoreLimit, ASubmissionThatDoesNotFitIsRefusedAndCounted) {
  Fill();
  Start();
  const wire::Reply refused = bench_.Upload(TextBlob("the log"));
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("more do not fit"), std::string::npos) << refused.message();
  EXPECT_EQ(bench_.hub->refusals().count(wire::RefusalKind::kStore), 1u);
  EXPECT_TRUE(bench_.hub->core().Jobs().empty());
  fs::remove(Filler());
  Start();
  EXPECT_TRUE(bench_.Ask(bench_.Submission(bench_.MakeJob())).ok());
}

TEST_F(StoreLimit, TheStatusSaysWhatTheStoreHoldsAndMayHold) {
  Fill();
  Start();
  wire::Message question;
  question.envelope.mutable_query();
  const wire::Reply reply = bench_.Ask(question);
  EXPECT_GE(reply.store_bytes(), kLimit_bytes);
  EXPECT_LT(reply.store_bytes(), kLimit_bytes + 100'000);
  EXPECT_EQ(reply.store_limit_bytes(), kLimit_bytes);
}

TEST(Retention, AJobThatEndedLongAgoGoesWithItsResultsOverRestarts) {
  constexpr double kDay_s = 86400;
  HubBench bench;
  bench.transport.ComeWorker("w");
  bench.Submit();
  bench.Until([&] { return bench.State() == "done"; });
  bench.hub->Shut(1);
  const fs::path results = bench.temp.path() / "results" / "a";
  const fs::path served = bench.temp.path() / "store" / "served";
  bench.hub.reset();
  ASSERT_TRUE(fs::exists(served)) << "so that a restart does not begin anew";
  ASSERT_TRUE(fs::exists(results / "stage0.h5"));

  bench.keep_s = 2 * kDay_s;
  ASSERT_TRUE(WriteServed(served, 1.9 * kDay_s).ok());
  bench.Start();
  for (int i = 0; i < 300; ++i) bench.hub->Step(0.001);
  EXPECT_EQ(bench.State(), "done");
  bench.hub.reset();

  ASSERT_TRUE(WriteServed(served, 2.1 * kDay_s).ok());
  bench.Start();
  bench.Until([&] { return bench.State().empty(); });
  EXPECT_TRUE(bench.Logged("a is deleted: it ended 2.1 days ago"));
  bench.Until([&] { return !fs::exists(results); });
  bench.Start();
  EXPECT_EQ(bench.State(), "") << "it does not come back";
}

}  // namespace
}  // namespace cairn::coordinator
