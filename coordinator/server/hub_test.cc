#include "coordinator/server/hub.h"

#include <gtest/gtest.h>

#include <fstream>

#include "coordinator/server/hub_bench.h"
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

TEST(Hub, RunsAJobAndPublishesItsResultsWithProvenance) {
  HubBench bench;
  bench.transport.ComeWorker("w");
  bench.Submit("a", 2);
  bench.Until([&] { return bench.State() == "done"; });
  for (const std::string stage : {"stage0", "stage1"}) {
    const auto file = ReadStoredFile(bench.temp.path() / "results/a" / (stage + ".h5"));
    ASSERT_TRUE(file.ok()) << file.status().message();
    EXPECT_EQ(file.value().kind, "result");
    EXPECT_TRUE(file.value().blob.Text("text").starts_with(stage));
    EXPECT_EQ(file.value().blob.Text("provenance/stage"), stage);
    EXPECT_EQ(file.value().blob.at("provenance/round/seconds_s").size(), 4);
    EXPECT_DOUBLE_EQ(file.value().blob.Get<double>("provenance/round/compute_s")[1], 1.5);
  }
  EXPECT_EQ(bench.folder->CheckpointNumbers("a").size(), 1u);
}

TEST(Hub, AnEndedJobLeavesNoBlobsBehind) {
  HubBench bench;
  bench.transport.ComeWorker("w");
  bench.Submit();
  bench.Until([&] { return bench.State() == "done"; });
  bench.hub.reset();  // the writer has done all
  EXPECT_EQ(FileCount(bench.folder->Blobs()), 0u);
}

TEST(Hub, ARestartGoesOnFromTheLastCheckpointToTheSameResult) {
  HubBench undisturbed;
  undisturbed.transport.ComeWorker("w");
  undisturbed.Submit();
  undisturbed.Until([&] { return undisturbed.State() == "done"; });

  HubBench bench;
  bench.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() == 2; };
  bench.transport.ComeWorker("w");
  bench.Submit();
  bench.Until([&] { return bench.hub->core().FindJob("a")->round == 2 && !bench.hub->core().HasUnsaved(); });
  bench.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() < 2; };
  bench.Start();
  EXPECT_EQ(bench.hub->core().FindJob("a")->round, 2u);
  bench.transport.ComeWorker("v");
  bench.Until([&] { return bench.State() == "done"; });
  const auto text = [](HubBench& b) {
    return ReadStoredFile(b.temp.path() / "results/a/stage0.h5").value().blob.Text("text");
  };
  EXPECT_EQ(text(bench), text(undisturbed));
}

// A job that stands still in round 2, saved.
void StandStill(HubBench& bench) {
  bench.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() == 2; };
  bench.transport.ComeWorker("w");
  bench.Submit();
  bench.Until([&] { return bench.hub->core().FindJob("a")->round == 2 && !bench.hub->core().HasUnsaved(); });
  bench.hub.reset();
  bench.transport.swallow = [](const wire::Assign&) { return false; };
}

TEST(Hub, ADamagedCheckpointIsNamedAndSetAsideAndTheOneBeforeIsUsed) {
  HubBench bench;
  StandStill(bench);
  const auto numbers = bench.folder->CheckpointNumbers("a");
  ASSERT_EQ(numbers.size(), 2u);
  const fs::path damaged = bench.folder->CheckpointFile("a", numbers[1]);
  Damage(damaged);
  bench.Start();
  EXPECT_TRUE(bench.Logged(damaged.string()));
  EXPECT_TRUE(fs::exists(damaged.string() + ".damaged"));
  EXPECT_EQ(bench.hub->core().FindJob("a")->saving.number, numbers[0]);
  bench.transport.ComeWorker("w");
  bench.Until([&] { return bench.State() == "done"; });
}

TEST(Hub, ACheckpointWhoseBlobIsDamagedIsNotUsed) {
  HubBench bench;
  StandStill(bench);
  const auto numbers = bench.folder->CheckpointNumbers("a");
  ASSERT_EQ(numbers.size(), 2u);
  const auto newest = ReadCheckpoint(bench.folder->CheckpointFile("a", numbers[1])).value();
  const fs::path blob =
      bench.folder->BlobFile(Hash::FromBinary(newest.step().state().blobs().at("shared")).value());
  Damage(blob);
  bench.Start();
  EXPECT_TRUE(fs::exists(blob.string() + ".damaged"));
  EXPECT_EQ(bench.hub->core().FindJob("a")->saving.number, numbers[0]);
  bench.transport.ComeWorker("w");
  bench.Until([&] { return bench.State() == "done"; });
}

TEST(Hub, AJobWithoutAGoodCheckpointIsSaidToBeLostAndOthersLiveOn) {
  HubBench bench;
  StandStill(bench);
  for (const std::uint64_t number : bench.folder->CheckpointNumbers("a"))
    Damage(bench.folder->CheckpointFile("a", number));
  bench.Start();
  EXPECT_TRUE(bench.Logged("it is lost"));
  EXPECT_EQ(bench.hub->core().FindJob("a"), nullptr);
  bench.transport.ComeWorker("w");
  bench.Submit("b");
  bench.Until([&] { return bench.State("b") == "done"; });
}

// One bit of its only checkpoint has flipped.
TEST(Hub, AJobThatIsDoneIsKnownByItsResultsWhereItsRecordIsDamaged) {
  HubBench bench;
  bench.transport.ComeWorker("w");
  bench.Submit("7-a", 2);
  bench.Until([&] { return bench.State("7-a") == "done" && !bench.hub->core().HasUnsaved(); });
  const std::vector<Hash> results = bench.hub->core().FindJob("7-a")->results;
  bench.hub.reset();
  ASSERT_EQ(bench.folder->CheckpointNumbers("7-a").size(), 1u);
  Damage(bench.folder->CheckpointFile("7-a", bench.folder->CheckpointNumbers("7-a")[0]));
  bench.Start();
  EXPECT_FALSE(bench.Logged("lost"));
  EXPECT_TRUE(bench.Logged("7-a: no checkpoint of it can be read, but all its results are there"));
  ASSERT_EQ(bench.State("7-a"), "done");
  EXPECT_EQ(bench.hub->core().FindJob("7-a")->results, results);
  bench.log.clear();
  bench.Start();
  EXPECT_EQ(bench.State("7-a"), "done");
  EXPECT_FALSE(bench.Logged("no checkpoint")) << "its record was written again";

  bench.hub.reset();
  Damage(bench.folder->CheckpointFile("7-a", bench.folder->CheckpointNumbers("7-a")[0]));
  Damage(bench.temp.path() / "results/7-a/stage1.h5");
  bench.Start();
  EXPECT_TRUE(bench.Logged("it is lost")) << "a result is damaged too";
}

TEST(Hub, BlobsOfNoCheckpointAreClearedAwayAtTheStart) {
  HubBench bench;
  StandStill(bench);
  const wire::NamedBlob left = TextBlob("left over");
  ASSERT_TRUE(WriteBlobFile(bench.folder->BlobFile(left.hash), "blob", *left.blob).ok());
  bench.Start();
  EXPECT_FALSE(fs::exists(bench.folder->BlobFile(left.hash)));
  EXPECT_GT(FileCount(bench.folder->Blobs()), 0u);
}

TEST(Hub, AJobTableThatIsLostOrDamagedIsMadeAnew) {
  HubBench bench;
  StandStill(bench);
  std::ofstream(bench.folder->JobTable()) << "this is no database, whatever its name says";
  bench.Start();
  EXPECT_TRUE(fs::exists(bench.folder->JobTable().string() + ".damaged"));
  bench.transport.ComeWorker("w");
  bench.Until([&] { return bench.State() == "done"; });
  bench.hub.reset();
  const auto rows = JobTable::Open(bench.folder->JobTable()).value().Read();
  ASSERT_TRUE(rows.ok());
  ASSERT_EQ(rows.value().size(), 1u);
  EXPECT_EQ(rows.value()[0].info.state(), "done");
}

TEST(Hub, ADiskThatCannotBeWrittenPausesTheJobWithTheReasonAndResumeGoesOn) {
  HubBench bench;
  fs::remove_all(bench.folder->Checkpoints());
  std::ofstream(bench.folder->Checkpoints()) << "a file where the folder should be";
  bench.transport.ComeWorker("w");
  bench.Submit();
  bench.Until([&] { return bench.State() == "paused"; });
  EXPECT_NE(bench.hub->core().Find("a")->reason().find("cannot save"), std::string::npos);
  fs::remove(bench.folder->Checkpoints());
  bench.hub->GoOn("a");
  bench.Until([&] { return bench.State() == "done"; });
}

TEST(Hub, BlobsBeyondTheMemoryCapLieOnDiskAndAreServedFromThere) {
  HubBench bench;
  bench.memory_bytes = 1;
  bench.Start();
  StandStill(bench);
  bench.Start();
  std::string input;
  bench.transport.swallow = [&input](const wire::Assign& assign) {
    input = assign.task().inputs(0).blob();
    return true;
  };
  bench.transport.ComeWorker("w");
  bench.Until([&] { return !input.empty(); });
  wire::Message fetch;
  fetch.envelope.mutable_fetch()->set_hash(input);
  bench.transport.Come("w", fetch);
  const auto served = [&] {
    return !bench.transport.sent.empty() && bench.transport.sent.back().second.envelope.has_blob();
  };
  bench.Until(served);
  EXPECT_EQ(bench.transport.sent.back().second.blobs.at(0).hash.Binary(), input);
  bench.transport.swallow = [](const wire::Assign&) { return false; };
  bench.transport.ComeWorker("w");
  bench.Until([&] { return bench.State() == "done"; });
}

TEST(Hub, ABlobThatNobodyHasIsMissing) {
  HubBench bench;
  wire::Message fetch;
  fetch.envelope.mutable_fetch()->set_hash(TextBlob("nowhere").hash.Binary());
  bench.transport.Come("w", fetch);
  bench.Until([&] { return !bench.transport.sent.empty(); });
  EXPECT_TRUE(bench.transport.sent.back().second.envelope.has_missing());
}

TEST(Hub, ARefusedMessageIsCountedAndNothingElseNotices) {
  HubBench bench;
  bench.transport.ComeWorker("w");
  bench.transport.ComeDamaged("stranger");
  bench.Submit();
  bench.Until([&] { return bench.State() == "done"; });
  EXPECT_EQ(bench.hub->refusals().count(wire::RefusalKind::kMalformed), 1u);
}

TEST(Hub, AWorkerWhoseConnectionIsGoneIsLostBeforeItsLeaseIsOver) {
  HubBench bench;
  bench.transport.swallow = [](const wire::Assign&) { return true; };
  bench.transport.ComeWorker("w");
  bench.Submit();
  bench.Until([&] { return bench.transport.assigned == 1; });
  bench.transport.gone = {"w"};
  bench.transport.swallow = [](const wire::Assign&) { return false; };
  bench.transport.ComeWorker("x");
  bench.Until([&] { return bench.State() == "done"; });
  EXPECT_EQ(bench.hub->core().fleet().size(), 1u);
}

TEST(Hub, ShutSavesWhatIsUnsavedAndSaysBye) {
  HubBench bench;
  bench.checkpoint_interval_s = 1e6;
  bench.Start();
  bench.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() == 2; };
  bench.transport.ComeWorker("w");
  bench.Submit();
  bench.Until([&] { return bench.hub->core().FindJob("a")->round == 2; });
  EXPECT_TRUE(bench.hub->Shut(10));
  EXPECT_TRUE(bench.transport.sent.back().second.envelope.has_bye());
  bench.Start();
  EXPECT_EQ(bench.hub->core().FindJob("a")->round, 2u);
}

}  // namespace
}  // namespace cairn::coordinator
