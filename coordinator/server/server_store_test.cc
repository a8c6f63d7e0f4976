// What a store may take, and for how long jobs stay in it.
#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/served_file.h"
#include "schema/store/blob_file.h"

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

// It was spilled meanwhile: the writing thread reads it back.
TEST(Publishing, AResultThatHadToWaitAndThatMemoryHadNoRoomForIsPublishedInTheEnd) {
  constexpr int kNumbers = 1 << 18;
  ServerFixture fixture;
  fixture.memory_bytes = 1;
  fixture.Start();
  Blob blob;
  blob.PutVector("values", std::vector<double>(kNumbers, 0.5));
  const wire::NamedBlob result = wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
  fixture.transport.results["w"] = result;
  const fs::path results = fixture.temp.path() / "results";
  std::ofstream(results) << "in the place of their folder";
  fixture.Submit();
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.State() == "paused"; });
  const auto has = [&](const Hash& hash) { return fs::exists(fixture.folder->BlobFile(hash)); };
  fixture.Until([&] { return has(result.hash); });
  for (int turn = 0; turn < 100; ++turn) fixture.server->Step(0.001);
  fs::remove(results);
  fixture.server->GoOn("a");
  fixture.Until([&] { return fixture.State() == "done" && !fixture.server->core().HasUnsaved(); });
  const Result<BlobFile> published = ReadStoredFile(results / "a" / "stage0.h5");
  ASSERT_TRUE(published.ok()) << published.status().message();
  EXPECT_EQ(published.value().blob.Without("provenance/").ContentHash(), result.hash);
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

// Of as many jobs, by which it is known that there were such.
void UntilLogsAreWritten(ServerFixture& fixture, std::size_t jobs) {
  fixture.Until([&] {
    return JobTable::JobsWithLogIn(fixture.folder->JobTable()).value().size() == jobs &&
           !fixture.server->core().HasUnsaved();
  });
}

// The disk's folder of a job is lost, with its number in the table: what it found is there.
TEST(CheckStore, ResultsOfWhichNothingElseIsLeftAreNamedAndTakenBack) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  for (const char* job : {"3-museum", "4-hall"}) {
    fixture.Submit(job, 2);
    fixture.Until([&] { return fixture.State(job) == "done"; });
  }
  UntilLogsAreWritten(fixture, 2);
  const auto results = fixture.temp.path() / "results";
  const auto before = fixture.server->core().FindJob("3-museum")->results;
  fixture.server.reset();
  for (const char* job : {"3-museum", "4-hall"})
    std::filesystem::remove_all(fixture.folder->Checkpoints() / job);
  std::filesystem::remove(results / "4-hall" / "stage1.h5");
  std::filesystem::create_directory(results / "mine");
  for (const bool adopt : {false, true}) {
    const StoreFindings found = CheckStore(*fixture.folder, results, adopt);
    EXPECT_EQ(found.jobs, 0u);
    ASSERT_EQ(found.damaged.size(), 1u);
    EXPECT_EQ(found.damaged[0].find("job 4-hall is lost: "), 0u) << found.damaged[0];
    EXPECT_EQ(found.orphaned, std::vector<std::string>{"3-museum"});
    EXPECT_EQ(found.unclaimed, (std::vector<std::string>{"4-hall", "mine"}))
        << "a part is no job that is done";
    EXPECT_EQ(std::filesystem::exists(fixture.folder->Checkpoints() / "3-museum"), adopt);
  }
  EXPECT_EQ(CheckStore(*fixture.folder, results, false).jobs, 1u);
  fixture.Start();
  EXPECT_EQ(fixture.State("3-museum"), "done");
  EXPECT_EQ(fixture.server->core().FindJob("3-museum")->results, before);
  EXPECT_EQ(fixture.server->core().Find("3-museum")->owner(), "");
  EXPECT_EQ(fixture.server->core().Jobs().size(), 1u);
}

TEST(CheckStore, TakesNothingBackThroughALinkNorTwoOfOneNumber) {
  namespace fs = std::filesystem;
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  for (const char* job : {"3-museum", "4-hall"}) {
    fixture.Submit(job);
    fixture.Until([&] { return fixture.State(job) == "done"; });
  }
  UntilLogsAreWritten(fixture, 2);
  const fs::path results = fixture.temp.path() / "results", elsewhere = fixture.temp.path() / "elsewhere";
  fixture.server.reset();
  fs::remove_all(fixture.folder->Checkpoints() / "3-museum");
  fs::rename(results / "3-museum", elsewhere);
  fs::create_directory_symlink(elsewhere, results / "3-museum");
  EXPECT_EQ(CheckStore(*fixture.folder, results, true).unclaimed, std::vector<std::string>{"3-museum"});
  fs::remove(results / "3-museum");
  fs::create_directory(results / "3-museum");
  fs::create_symlink(elsewhere / "stage0.h5", results / "3-museum" / "stage0.h5");
  EXPECT_EQ(CheckStore(*fixture.folder, results, true).unclaimed, std::vector<std::string>{"3-museum"});
  fs::remove_all(results / "3-museum");

  for (const char* copy : {"3-museum", "3-copy", "4-copy"}) fs::copy(elsewhere, results / copy);
  const StoreFindings found = CheckStore(*fixture.folder, results, true);
  EXPECT_TRUE(found.orphaned.empty());
  ASSERT_EQ(found.damaged.size(), 4u);
  EXPECT_EQ(found.damaged[3].find("job 3-museum is lost: "), 0u) << found.damaged[3];
  EXPECT_EQ(found.damaged[0],
            "results/3-copy would be a job of the number that '3-museum' has: move away what is a copy");
  EXPECT_NE(found.damaged[2].find("results/4-copy would be a job of the number that '4-hall' has"),
            std::string::npos)
      << found.damaged[2];
  EXPECT_FALSE(fs::exists(fixture.folder->Checkpoints() / "3-museum"));
  fs::remove_all(results / "3-copy");
  EXPECT_EQ(CheckStore(*fixture.folder, results, true).orphaned, std::vector<std::string>{"3-museum"});
}

TEST(CheckStore, TakesNothingBackOfANumberThatLeavesNoneForOthers) {
  namespace fs = std::filesystem;
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit("3-museum");
  fixture.Until([&] { return fixture.State("3-museum") == "done"; });
  const fs::path results = fixture.temp.path() / "results";
  fixture.server.reset();
  fs::remove_all(fixture.folder->Checkpoints() / "3-museum");
  const std::string most = "9007199254740992-x";
  for (const std::string& copy :
       {most, std::string("9007199254740993-x"), std::string("9223372036854775807-x"),
        std::string("9223372036854775808-x"), std::string("18446744073709551617-x")})
    fs::copy(results / "3-museum", results / copy);
  const StoreFindings found = CheckStore(*fixture.folder, results, true);
  EXPECT_EQ(found.orphaned, (std::vector<std::string>{"3-museum", most}));
  EXPECT_EQ(found.unclaimed, (std::vector<std::string>{"18446744073709551617-x", "9223372036854775808-x"}));
  ASSERT_EQ(found.damaged.size(), 2u);
  EXPECT_EQ(
      found.damaged[1],
      "results/9223372036854775807-x would be a job of a number above 9007199254740992, which no service "
      "gave, and would leave none for the jobs after it: rename it");
  EXPECT_FALSE(fs::exists(fixture.folder->Checkpoints() / "9223372036854775807-x"));
}

TEST(CheckStore, NamesWhatIsDamagedAndTouchesNothing) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit("3-museum");
  fixture.Until([&] { return fixture.State("3-museum") == "done"; });
  fixture.server.reset();
  const auto results = fixture.temp.path() / "results";
  EXPECT_TRUE(CheckStore(*fixture.folder, results, true).damaged.empty());
  std::ofstream(results / "3-museum" / "stage0.h5") << "damaged";
  ASSERT_EQ(CheckStore(*fixture.folder, results, true).damaged.size(), 1u);
  const auto checkpoint =
      fixture.folder->CheckpointFile("3-museum", fixture.folder->CheckpointNumbers("3-museum").back());
  std::ofstream(checkpoint) << "damaged";
  const StoreFindings found = CheckStore(*fixture.folder, results, true);
  ASSERT_EQ(found.damaged.size(), 1u);
  EXPECT_NE(found.damaged[0].find("job 3-museum: "), std::string::npos) << found.damaged[0];
  EXPECT_TRUE(std::filesystem::exists(checkpoint)) << "whatever a start would do with it";
}

// What its log tells is all that is known of it: its folder went with a bad disk, say.
TEST(CheckStore, AJobThatHasLostItsCheckpointsIsNamedAndItsBlobsStayUntilItIsGivenUp) {
  namespace fs = std::filesystem;
  ServerFixture fixture;
  const Hash input = TextBlob("the log").hash;
  const auto lines = [&] { return JobTable::JobsWithLogIn(fixture.folder->JobTable()).value(); };
  const auto is_there = [&] {
    return fs::exists(fixture.folder->BlobFile(input)) || fs::exists(fixture.folder->FlatFile(input));
  };
  const auto ask = [&](const char* action, const char* job) {
    wire::Message message;
    message.envelope.mutable_query()->set_job(job);
    message.envelope.mutable_query()->set_action(action);
    EXPECT_TRUE(fixture.Ask(message).ok()) << action;
  };
  for (const char* job : {"2-two", "3-gone"}) fixture.Submit(job);
  UntilLogsAreWritten(fixture, 2);
  for (const char* action : {"cancel", "delete"}) ask(action, "3-gone");
  EXPECT_EQ(lines(), std::vector<std::string>{"2-two"}) << "what is deleted is not lost";
  ASSERT_TRUE(is_there());
  fixture.server.reset();
  fs::rename(fixture.folder->Checkpoints() / "2-two", fixture.temp.path() / "lost");
  const auto damaged = [&] {
    return CheckStore(*fixture.folder, fixture.temp.path() / "none", false).damaged;
  };
  ASSERT_EQ(damaged().size(), 1u);
  EXPECT_EQ(damaged()[0].find("job 2-two is lost: none of its checkpoints is in "), 0u) << damaged()[0];
  for (int start = 0; start < 2; ++start) {
    fixture.Start();
    EXPECT_TRUE(fixture.Logged("job 2-two is lost: none of its checkpoints is in "));
    EXPECT_TRUE(is_there());
  }
  fixture.Submit("4-same");  // of the same input, which it leaves
  for (const char* action : {"cancel", "delete"}) ask(action, "4-same");
  wire::Message clean;
  clean.envelope.mutable_clean()->set_damaged(false);
  EXPECT_NE(fixture.Ask(clean).message().find("job 2-two is lost"), std::string::npos);
  EXPECT_TRUE(is_there());
  clean.envelope.mutable_clean()->set_damaged(true);
  for (const bool dry_run : {true, false}) {
    clean.envelope.mutable_clean()->set_dry_run(dry_run);
    const wire::Reply reply = fixture.Ask(clean);
    ASSERT_GT(reply.cleaned_size(), 0) << reply.message();
    EXPECT_EQ(reply.cleaned(0).what(), "logs of lost jobs");
    EXPECT_EQ(is_there(), dry_run);
  }
  EXPECT_TRUE(damaged().empty());
}

// Beside the coordinator of a new build, whose store is another.
TEST(Draining, TakesNoNewJobsAndIsOverOnceThoseThatItHasAreDone) {
  ServerFixture fixture;
  const wire::Message submission = fixture.Submission(fixture.MakeJob());
  const std::string job = fixture.Ask(submission).jobs(0).id();
  fixture.Submit("held");
  fixture.drains = true;
  fixture.Start();
  wire::Message pause;
  pause.envelope.mutable_query()->set_job("held");
  pause.envelope.mutable_query()->set_action("pause");
  ASSERT_TRUE(fixture.Ask(pause).ok());
  proto::Job other = fixture.MakeJob();
  other.set_seed(7);
  const wire::Reply refused = fixture.Ask(fixture.Submission(other, false));
  EXPECT_NE(refused.message().find("takes no new jobs"), std::string::npos) << refused.message();
  EXPECT_TRUE(refused.unable()) << "elsewhere it is right";
  EXPECT_TRUE(fixture.Ask(submission).known()) << "what it has it does";
  EXPECT_FALSE(fixture.server->HasDrained());
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.server->HasDrained(); });
  EXPECT_EQ(fixture.State(job), "done");
  EXPECT_EQ(fixture.State("held"), "paused");
}

}  // namespace
}  // namespace cairn::coordinator
