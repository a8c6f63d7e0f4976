#include "coordinator/server/server.h"

#include <gtest/gtest.h>

#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/checkpoint_file.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

std::size_t FileCount(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// Here and there all over the file: a single byte may be one that means nothing.
void Damage(const fs::path& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  for (std::streamoff at = 40; at < static_cast<std::streamoff>(fs::file_size(path)); at += 40) {
    file.seekg(at);
    const char byte = static_cast<char>(file.get() ^ 0x40);
    file.seekp(at);
    file.put(byte);
  }
}

TEST(Server, RunsAJobAndPublishesItsResultsWithProvenance) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit("a", 2);
  fixture.Until([&] { return fixture.State() == "done"; });
  for (const std::string stage : {"stage0", "stage1"}) {
    const auto file = ReadStoredFile(fixture.temp.path() / "results/a" / (stage + ".h5"));
    ASSERT_TRUE(file.ok()) << file.status().message();
    EXPECT_EQ(file.value().kind, "result");
    EXPECT_TRUE(file.value().blob.Text("text").starts_with(stage));
    EXPECT_EQ(file.value().blob.Text("provenance/stage"), stage);
    EXPECT_EQ(file.value().blob.at("provenance/round/seconds_s").size(), 4);
    EXPECT_DOUBLE_EQ(file.value().blob.Get<double>("provenance/round/compute_s")[1], 1.5);
  }
  EXPECT_EQ(fixture.folder->CheckpointNumbers("a").size(), 1u);
}

TEST(Server, AnEndedJobLeavesNoBlobsBehind) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return fixture.State() == "done"; });
  fixture.server.reset();  // the writer has done all
  EXPECT_EQ(FileCount(fixture.folder->Blobs()), 0u);
}

TEST(Server, ARestartGoesOnFromTheLastCheckpointToTheSameResult) {
  ServerFixture undisturbed;
  undisturbed.transport.ComeWorker("w");
  undisturbed.Submit();
  undisturbed.Until([&] { return undisturbed.State() == "done"; });

  ServerFixture fixture;
  fixture.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() == 2; };
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] {
    return fixture.server->core().FindJob("a")->round == 2 && !fixture.server->core().HasUnsaved();
  });
  fixture.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() < 2; };
  fixture.Start();
  EXPECT_EQ(fixture.server->core().FindJob("a")->round, 2u);
  fixture.transport.ComeWorker("v");
  fixture.Until([&] { return fixture.State() == "done"; });
  const auto text = [](ServerFixture& b) {
    return ReadStoredFile(b.temp.path() / "results/a/stage0.h5").value().blob.Text("text");
  };
  EXPECT_EQ(text(fixture), text(undisturbed));
}

// A job that stands still in round 2, saved.
void StandStill(ServerFixture& fixture) {
  fixture.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() == 2; };
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] {
    return fixture.server->core().FindJob("a")->round == 2 && !fixture.server->core().HasUnsaved();
  });
  fixture.server.reset();
  fixture.transport.swallow = [](const wire::Assign&) { return false; };
}

TEST(Server, ADamagedCheckpointIsNamedAndQuarantinedAndTheOneBeforeIsUsed) {
  ServerFixture fixture;
  StandStill(fixture);
  const auto numbers = fixture.folder->CheckpointNumbers("a");
  ASSERT_EQ(numbers.size(), 2u);
  const fs::path damaged = fixture.folder->CheckpointFile("a", numbers[1]);
  Damage(damaged);
  fixture.Start();
  EXPECT_TRUE(fixture.Logged(damaged.string()));
  EXPECT_TRUE(fs::exists(damaged.string() + ".damaged"));
  EXPECT_EQ(fixture.server->core().FindJob("a")->saving.number, numbers[0]);
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.State() == "done"; });
}

TEST(Server, ACheckpointWhoseBlobIsDamagedIsNotUsed) {
  ServerFixture fixture;
  StandStill(fixture);
  const auto numbers = fixture.folder->CheckpointNumbers("a");
  ASSERT_EQ(numbers.size(), 2u);
  const auto newest = ReadCheckpoint(fixture.folder->CheckpointFile("a", numbers[1])).value();
  const fs::path blob =
      fixture.folder->BlobFile(Hash::FromBinary(newest.step().state().blobs().at("shared")).value());
  Damage(blob);
  fixture.Start();
  EXPECT_TRUE(fs::exists(blob.string() + ".damaged"));
  EXPECT_EQ(fixture.server->core().FindJob("a")->saving.number, numbers[0]);
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.State() == "done"; });
}

TEST(Server, AJobWithoutAGoodCheckpointIsSaidToBeLostAndOthersLiveOn) {
  ServerFixture fixture;
  StandStill(fixture);
  for (const std::uint64_t number : fixture.folder->CheckpointNumbers("a"))
    Damage(fixture.folder->CheckpointFile("a", number));
  fixture.Start();
  EXPECT_TRUE(fixture.Logged("it is lost"));
  EXPECT_EQ(fixture.server->core().FindJob("a"), nullptr);
  fixture.transport.ComeWorker("w");
  fixture.Submit("b");
  fixture.Until([&] { return fixture.State("b") == "done"; });
}

// One bit of its only checkpoint has flipped.
TEST(Server, AJobThatIsDoneIsKnownByItsResultsWhereItsRecordIsDamaged) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit("7-a", 2);
  fixture.Until([&] { return fixture.State("7-a") == "done" && !fixture.server->core().HasUnsaved(); });
  const std::vector<Hash> results = fixture.server->core().FindJob("7-a")->results;
  fixture.server.reset();
  ASSERT_EQ(fixture.folder->CheckpointNumbers("7-a").size(), 1u);
  Damage(fixture.folder->CheckpointFile("7-a", fixture.folder->CheckpointNumbers("7-a")[0]));
  fixture.Start();
  EXPECT_FALSE(fixture.Logged("lost"));
  EXPECT_TRUE(fixture.Logged("7-a: no checkpoint of it can be read, but all its results are there"));
  ASSERT_EQ(fixture.State("7-a"), "done");
  EXPECT_EQ(fixture.server->core().FindJob("7-a")->results, results);
  fixture.log.clear();
  fixture.Start();
  EXPECT_EQ(fixture.State("7-a"), "done");
  EXPECT_FALSE(fixture.Logged("no checkpoint")) << "its record was written again";

  fixture.server.reset();
  Damage(fixture.folder->CheckpointFile("7-a", fixture.folder->CheckpointNumbers("7-a")[0]));
  Damage(fixture.temp.path() / "results/7-a/stage1.h5");
  fixture.Start();
  EXPECT_TRUE(fixture.Logged("it is lost")) << "a result is damaged too";
}

TEST(Server, BlobsOfNoCheckpointAreClearedAwayAtTheStart) {
  ServerFixture fixture;
  StandStill(fixture);
  const wire::NamedBlob left = TextBlob("left over");
  ASSERT_TRUE(WriteBlobFile(fixture.folder->BlobFile(left.hash), "blob", *left.blob).ok());
  fixture.Start();
  EXPECT_FALSE(fs::exists(fixture.folder->BlobFile(left.hash)));
  EXPECT_GT(FileCount(fixture.folder->Blobs()), 0u);
}

TEST(Server, AJobTableThatIsLostOrDamagedIsMadeAnew) {
  ServerFixture fixture;
  StandStill(fixture);
  std::ofstream(fixture.folder->JobTable()) << "this is no database, whatever its name says";
  fixture.Start();
  EXPECT_TRUE(fs::exists(fixture.folder->JobTable().string() + ".damaged"));
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.State() == "done"; });
  fixture.server.reset();
  const auto lines = JobTable::Open(fixture.folder->JobTable()).value().ReadLog("a", 0);
  ASSERT_TRUE(lines.ok());
  EXPECT_FALSE(lines.value().empty());
}

TEST(Server, ADiskThatCannotBeWrittenPausesTheJobWithTheReasonAndResumeGoesOn) {
  ServerFixture fixture;
  fs::remove_all(fixture.folder->Checkpoints());
  std::ofstream(fixture.folder->Checkpoints()) << "a file where the folder should be";
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return fixture.State() == "paused"; });
  EXPECT_NE(fixture.server->core().Find("a")->reason().find("cannot save"), std::string::npos);
  fs::remove(fixture.folder->Checkpoints());
  fixture.server->GoOn("a");
  fixture.Until([&] { return fixture.State() == "done"; });
}

TEST(Server, BlobsBeyondTheMemoryCapLieOnDiskAndAreServedFromThere) {
  ServerFixture fixture;
  fixture.memory_bytes = 1;
  fixture.Start();
  StandStill(fixture);
  fixture.Start();
  std::string input;
  fixture.transport.swallow = [&input](const wire::Assign& assign) {
    input = assign.task().inputs(0).blob();
    return true;
  };
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return !input.empty(); });
  wire::Message fetch;
  fetch.envelope.mutable_fetch()->set_hash(input);
  fixture.transport.Come("w", fetch);
  const auto served = [&] {
    return !fixture.transport.sent.empty() && fixture.transport.sent.back().second.envelope.has_blob();
  };
  fixture.Until(served);
  EXPECT_EQ(fixture.transport.sent.back().second.blobs.at(0).hash.Binary(), input);
  fixture.transport.swallow = [](const wire::Assign&) { return false; };
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.State() == "done"; });
}

TEST(Server, ABlobThatNobodyHasIsMissing) {
  ServerFixture fixture;
  wire::Message fetch;
  fetch.envelope.mutable_fetch()->set_hash(TextBlob("nowhere").hash.Binary());
  fixture.transport.Come("w", fetch);
  fixture.Until([&] { return !fixture.transport.sent.empty(); });
  EXPECT_TRUE(fixture.transport.sent.back().second.envelope.has_missing());
}

TEST(Server, ARefusedMessageIsCountedAndNothingElseNotices) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.transport.ComeDamaged("stranger");
  fixture.Submit();
  fixture.Until([&] { return fixture.State() == "done"; });
  EXPECT_EQ(fixture.server->refusals().count(wire::RefusalKind::kMalformed), 1u);
}

// Its job could neither be saved nor cancelled, or its result not be read.
TEST(Server, AResultThatNoFileHoldsIsNotTaken) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"a", "a/b"}, "lies in 'a', which is a dataset"},
      {{"a\nb"}, "has control characters"},
      {{"provenance/kind"}, "its result has a provenance already"}};
  for (const auto& [names, why] : cases) {
    ServerFixture fixture;
    Blob blob;
    for (const std::string& name : names) blob.PutScalar(name, 1.0);
    fixture.transport.results["w"] = wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
    fixture.transport.ComeWorker("w");
    fixture.Submit();
    fixture.Until([&] { return fixture.State() == "failed"; });
    EXPECT_NE(fixture.server->core().Find("a")->reason().find(why), std::string::npos)
        << fixture.server->core().Find("a")->reason();
  }
}

TEST(Server, AWorkerWhoseConnectionIsGoneIsLostBeforeItsLeaseIsOver) {
  ServerFixture fixture;
  fixture.transport.swallow = [](const wire::Assign&) { return true; };
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return fixture.transport.assigned == 1; });
  fixture.transport.gone = {"w"};
  fixture.transport.swallow = [](const wire::Assign&) { return false; };
  fixture.transport.ComeWorker("x");
  const Fleet& fleet = fixture.server->core().fleet();
  fixture.Until([&] { return fleet.Knows("x") && !fleet.Knows("w"); });
  wire::Message heartbeat;
  heartbeat.envelope.mutable_heartbeat();
  fixture.transport.Come("x", std::move(heartbeat));
  fixture.Until([&] { return fixture.State() == "done"; });
}

// It ended its connection behind them: a message to it fails before they are read.
TEST(Server, TheLastWordsOfAWorkerThatIsGoneCountFirst) {
  ServerFixture fixture;
  std::optional<wire::Assign> taken;
  fixture.transport.swallow = [&taken](const wire::Assign& assign) {
    taken = assign;
    return true;
  };
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return taken.has_value(); });
  wire::Message heartbeat;
  heartbeat.envelope.mutable_heartbeat();
  *heartbeat.envelope.mutable_heartbeat()->add_tasks() = taken->key();
  wire::Message drain;
  drain.envelope.mutable_drain();
  fixture.transport.gone = {"w"};
  fixture.transport.Come("w", std::move(heartbeat));
  fixture.transport.Come("w", std::move(drain));  // answered, in vain
  fixture.server->Step(0);
  fixture.transport.at_once = 1;  // and others have much to say
  for (int i = 0; i < 3; ++i) fixture.transport.ComeDamaged("stranger");
  fixture.transport.ComeAnswer("w", *taken);
  wire::Message leave;
  leave.envelope.mutable_leave();
  fixture.transport.Come("w", std::move(leave));
  fixture.Until([&] { return !fixture.server->core().fleet().Knows("w"); });
  EXPECT_TRUE(fixture.Logged("left"));
  EXPECT_FALSE(fixture.Logged("lost its connection"));
  EXPECT_EQ(fixture.server->core().FindJob("a")->round, 0u);
  EXPECT_FALSE(fixture.Logged("failed"));
}

TEST(Server, ShutSavesWhatIsUnsavedAndSendsLeave) {
  ServerFixture fixture;
  fixture.checkpoint_interval_s = 1e6;
  fixture.Start();
  fixture.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() == 2; };
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return fixture.server->core().FindJob("a")->round == 2; });
  EXPECT_TRUE(fixture.server->Shut(10));
  EXPECT_TRUE(fixture.transport.sent.back().second.envelope.has_leave());
  fixture.Start();
  EXPECT_EQ(fixture.server->core().FindJob("a")->round, 2u);
}

// What comes of it must not be done for a job that is as it was before after a crash.
TEST(JobEnded, IsToldOnceOfEachEndOnceThatIsDurable) {
  ServerFixture fixture;
  std::vector<std::string> told;
  fixture.job_ended = [&](const wire::JobInfo& job) {
    told.push_back(job.id() + " " + job.state());
    EXPECT_EQ(ReadCheckpoint(fixture.folder->CheckpointFile(
                                 job.id(), fixture.folder->CheckpointNumbers(job.id()).back()))
                  .value()
                  .state(),
              fixture.server->core().FindJob(job.id())->state);
  };
  fixture.Start();
  fixture.transport.ComeWorker("w");
  fixture.Submit("a");
  fixture.Until([&] { return fixture.State("a") == "done"; });
  fixture.transport.swallow = [&](const wire::Assign& assign) {
    wire::Message failed;
    *failed.envelope.mutable_failed()->mutable_key() = assign.key();
    failed.envelope.mutable_failed()->set_input_error(true);
    fixture.transport.Come("w", failed);
    return true;
  };
  fixture.Submit("b");
  fixture.Until([&] { return told.size() == 2; });
  fixture.server->GoOn("b");
  fixture.Until([&] { return told.size() == 3; });
  EXPECT_EQ(told, (std::vector<std::string>{"a done", "b failed", "b failed"}));
  fixture.Start();
  wire::Message priority;
  priority.envelope.mutable_query()->set_job("b");
  priority.envelope.mutable_query()->set_action("priority");
  priority.envelope.mutable_query()->set_priority(3);
  EXPECT_TRUE(fixture.Ask(priority).ok());
  EXPECT_EQ(told.size(), 3u) << "what had ended before, and is only saved again";
}

}  // namespace
}  // namespace cairn::coordinator
