#include "coordinator/store/cleaner.h"

#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/blob_pack.h"
#include "coordinator/store/checkpoint_file.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::uint64_t> CleanerFiles(const Cleaned& cleaned) {
  std::map<std::string, std::uint64_t> files;
  for (const wire::Cleaned& kind : cleaned.removed) {
    files[kind.what()] = kind.files();
    EXPECT_GT(kind.bytes(), 0u) << kind.what();
  }
  return files;
}

// A store with a job that runs, and with one of each that nobody needs.
class Clean : public ::testing::Test {
 protected:
  void SetUp() override {
    fixture_.Submit();
    fixture_.Until([&] { return fixture_.folder->CheckpointNumbers("a").size() == 1; });
    Plant();
  }
  void Plant() {
    const StoreFolder& folder = *fixture_.folder;
    const wire::NamedBlob orphan = TextBlob("nobody's"), other = TextBlob("nobody's either");
    const Blob pack = PackBlobs({other});
    planted_ = {folder.BlobFile(orphan.hash), folder.PackFile(pack.ContentHash()),
                folder.Blobs() / ".cairn-x.h5.999999999-0.tmp"};
    damaged_ = folder.Blobs() / "x.h5.damaged";
    ASSERT_TRUE(WriteBlobFile(planted_[0], "blob", *orphan.blob).ok());
    ASSERT_TRUE(WriteBlobFile(planted_[1], "pack", pack).ok());
    std::ofstream(planted_[2]) << "half";
    std::ofstream(damaged_) << "damaged";
  }
  std::set<fs::path> Tree() const {
    std::set<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fixture_.temp.path()))
      if (entry.is_regular_file()) files.insert(entry.path());
    return files;
  }
  Cleaned Offline(const CleanOptions& options) {
    fixture_.server.reset();
    fixture_.folder.reset();
    const StoreFolder folder = StoreFolder::OpenAsItIs(fixture_.temp.path() / "store").value();
    return CleanStore(folder, options, HashesInPack);
  }
  void ExpectItGoesOn() {
    fixture_.Start();
    fixture_.transport.ComeWorker("w");
    fixture_.Until([&] { return fixture_.State() == "done"; });
  }

  const std::map<std::string, std::uint64_t> all_ = {
      {"orphaned blobs", 1}, {"orphaned packs", 1}, {"temporary files", 1}};
  ServerFixture fixture_;
  std::vector<fs::path> planted_;
  fs::path damaged_;
};

TEST_F(Clean, RemovesWhatNobodyNeedsAndNothingElse) {
  const std::set<fs::path> before = Tree();
  EXPECT_EQ(CleanerFiles(Offline({})), all_);
  std::set<fs::path> expected = before;
  for (const fs::path& path : planted_) {
    EXPECT_TRUE(before.contains(path)) << path;
    expected.erase(path);
  }
  std::set<fs::path> after = Tree();
  for (std::set<fs::path>* tree : {&expected, &after})
    std::erase_if(*tree, [](const fs::path& p) { return p.filename().string().starts_with("jobs.sqlite-"); });
  expected.insert(fixture_.temp.path() / "store" / "served");
  after.insert(fixture_.temp.path() / "store" / "served");
  EXPECT_EQ(after, expected);
  EXPECT_TRUE(Offline({}).removed.empty()) << "the second time there is nothing";
  ExpectItGoesOn();
}

TEST_F(Clean, ADryRunSaysTheSameAndTouchesNothing) {
  CleanOptions options;
  options.damaged = options.dry_run = true;
  auto expected = all_;
  expected["damaged files"] = 1;
  EXPECT_EQ(CleanerFiles(Offline(options)), expected);
  const std::set<fs::path> before = Tree();
  EXPECT_EQ(CleanerFiles(Offline(options)), expected);
  EXPECT_EQ(Tree(), before);
}

TEST_F(Clean, WhatIsDamagedGoesWhereAskedFor) {
  Offline({});
  EXPECT_TRUE(fs::exists(damaged_));
  CleanOptions options;
  options.damaged = true;
  EXPECT_EQ(CleanerFiles(Offline(options)), (std::map<std::string, std::uint64_t>{{"damaged files", 1}}));
  EXPECT_FALSE(fs::exists(damaged_));
}

TEST_F(Clean, WhereACheckpointCannotBeReadNoBlobGoes) {
  const fs::path checkpoint = fixture_.folder->CheckpointFile("a", 1);
  fs::resize_file(checkpoint, 100);
  const Cleaned cleaned = Offline({});
  EXPECT_NE(cleaned.note.find(checkpoint.string()), std::string::npos) << cleaned.note;
  EXPECT_EQ(CleanerFiles(cleaned), (std::map<std::string, std::uint64_t>{{"temporary files", 1}}));
}

TEST_F(Clean, CheckpointsButTheLastTwoGo) {
  const Result<proto::Checkpoint> first = ReadCheckpoint(fixture_.folder->CheckpointFile("a", 1));
  ASSERT_TRUE(first.ok());
  for (const std::uint64_t number : {2, 3, 4}) {
    proto::Checkpoint later = first.value();
    later.set_number(number);
    ASSERT_TRUE(WriteCheckpoint(fixture_.folder->CheckpointFile("a", number), later).ok());
  }
  EXPECT_EQ(CleanerFiles(Offline({})).at("old checkpoints"), 2u);
  fixture_.Start();
  EXPECT_EQ(fixture_.folder->CheckpointNumbers("a"), (std::vector<std::uint64_t>{3, 4}));
}

TEST_F(Clean, ARunningServiceCleansAndItsJobsGoOn) {
  fixture_.transport.tasks = 12;  // enough for a pack
  fixture_.transport.swallow = [](const wire::Assign& assign) { return assign.task().index() == 11; };
  fixture_.transport.ComeWorker("w");
  fixture_.Until([&] { return fixture_.transport.assigned > 11; });
  wire::Message question;
  question.envelope.mutable_clean()->set_dry_run(true);
  EXPECT_EQ(fixture_.Ask(question).cleaned_size(), 3);
  for (const fs::path& path : planted_) EXPECT_TRUE(fs::exists(path)) << path;
  question.envelope.mutable_clean()->set_dry_run(false);
  const wire::Reply reply = fixture_.Ask(question);
  EXPECT_TRUE(reply.ok());
  EXPECT_EQ(reply.cleaned_size(), 3) << reply.DebugString();
  for (const fs::path& path : planted_) EXPECT_FALSE(fs::exists(path)) << path;
  EXPECT_TRUE(fs::exists(damaged_));
  fixture_.transport.swallow = [](const wire::Assign&) { return false; };
  ExpectItGoesOn();
}

TEST(CleanStore, IsForOneAtATime) {
  ServerFixture fixture;
  EXPECT_EQ(StoreFolder::OpenAsItIs(fixture.temp.path() / "store").status().code(), Code::kBusy);
}

}  // namespace
}  // namespace cairn::coordinator
