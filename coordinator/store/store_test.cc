// The parts of the store, each by itself.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <map>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/job_yaml.h"
#include "coordinator/store/recovery.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

proto::Checkpoint SomeCheckpoint() {
  proto::Checkpoint checkpoint;
  checkpoint.set_job_id("a");
  checkpoint.set_number(3);
  checkpoint.mutable_job()->add_stages()->set_name("one");
  (*checkpoint.mutable_step()->mutable_state()->mutable_scalars())["x"].set_d(0.1);
  checkpoint.add_blobs(TextBlob("b").hash.Binary());
  return checkpoint;
}

TEST(CheckpointFile, RoundTrips) {
  TempFolder temp;
  ASSERT_TRUE(WriteCheckpoint(temp.path() / "3.h5", SomeCheckpoint()).ok());
  const auto read = ReadCheckpoint(temp.path() / "3.h5");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(HashOfMessage(read.value()), HashOfMessage(SomeCheckpoint()));
}

TEST(CheckpointFile, ATruncatedOneIsNeverTakenForGood) {
  TempFolder temp;
  ASSERT_TRUE(WriteCheckpoint(temp.path() / "3.h5", SomeCheckpoint()).ok());
  const auto size = fs::file_size(temp.path() / "3.h5");
  for (std::uintmax_t length = 0; length < size; length += 97) {
    fs::copy_file(temp.path() / "3.h5", temp.path() / "cut.h5", fs::copy_options::overwrite_existing);
    fs::resize_file(temp.path() / "cut.h5", length);
    EXPECT_FALSE(ReadCheckpoint(temp.path() / "cut.h5").ok()) << length;
  }
}

TEST(CheckpointFile, AFlippedByteNeverGivesAnotherCheckpoint) {
  TempFolder temp;
  ASSERT_TRUE(WriteCheckpoint(temp.path() / "3.h5", SomeCheckpoint()).ok());
  std::ifstream in(temp.path() / "3.h5", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  int refused = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 13) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    std::ofstream(temp.path() / "flip.h5", std::ios::binary) << flipped;
    const auto read = ReadCheckpoint(temp.path() / "flip.h5");
    if (!read.ok())
      ++refused;
    else  // a byte that means nothing
      EXPECT_EQ(HashOfMessage(read.value()), HashOfMessage(SomeCheckpoint())) << at;
  }
  EXPECT_GT(refused, 0);
}

TEST(CheckpointFile, PartsThatDoNotFitTogetherAreRefused) {
  TempFolder temp;
  const auto refused = [&](const std::function<void(proto::Checkpoint&)>& change) {
    proto::Checkpoint checkpoint = SomeCheckpoint();
    change(checkpoint);
    EXPECT_TRUE(WriteCheckpoint(temp.path() / "x.h5", checkpoint).ok());
    return ReadCheckpoint(temp.path() / "x.h5").status().code() == Code::kCorrupt;
  };
  EXPECT_TRUE(refused([](proto::Checkpoint& c) { c.set_stage(1); }));
  EXPECT_TRUE(refused([](proto::Checkpoint& c) { c.set_number(0); }));
  EXPECT_TRUE(refused([](proto::Checkpoint& c) { c.add_blobs("short"); }));
  EXPECT_TRUE(refused([](proto::Checkpoint& c) { c.mutable_step()->add_tasks()->set_index(9); }));
}

// A small file of zeros may unpack to gigabytes.
TEST(CheckpointFile, OneThatUnpacksToFarMoreThanACheckpointDoesIsDamaged) {
  TempFolder temp;
  Blob blob;
  blob.PutVector("checkpoint", std::vector<std::uint8_t>((std::size_t{64} << 20) + 1));
  ASSERT_TRUE(WriteBlobFile(temp.path() / "3.h5", "checkpoint", blob).ok());
  const Status status = ReadCheckpoint(temp.path() / "3.h5").status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_NE(status.message().find("more than 67.1 MB unpacked"), std::string::npos) << status.message();
}

// A FIFO would wait for whoever writes into it.
TEST(StoreFolder, AVersionThatIsNoFileIsRefused) {
  const TempFolder temp;
  ASSERT_TRUE(StoreFolder::Open(temp.path() / "s").ok());
  const std::filesystem::path version = temp.path() / "s" / "version";
  std::filesystem::remove(version);
  ASSERT_EQ(::mkfifo(version.c_str(), 0600), 0);
  EXPECT_EQ(StoreFolder::Open(temp.path() / "s").status().code(), Code::kRefused);
  std::filesystem::remove(version);
  std::ofstream(version) << "two\n";
  EXPECT_EQ(StoreFolder::Open(temp.path() / "s").status().code(), Code::kCorrupt);
}

TEST(StoreFolder, HasOneOwner) {
  TempFolder temp;
  {
    const auto first = StoreFolder::Open(temp.path() / "s");
    ASSERT_TRUE(first.ok());
    EXPECT_EQ(StoreFolder::Open(temp.path() / "s").status().code(), Code::kBusy);
  }
  EXPECT_TRUE(StoreFolder::Open(temp.path() / "s").ok());
}

// Of all files below a folder, but for the lock.
std::map<std::string, std::string> Contents(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().filename() == "lock") continue;
    std::ifstream in(entry.path(), std::ios::binary);
    contents[entry.path()] = std::string(std::istreambuf_iterator<char>(in), {});
  }
  return contents;
}

TEST(StoreFolder, ANewerVersionIsRefusedAndNotTouched) {
  TempFolder temp;
  ASSERT_TRUE(StoreFolder::Open(temp.path() / "s").ok());
  ASSERT_TRUE(StoreFolder::Open(temp.path() / "s").ok()) << "its own version";
  std::ofstream(temp.path() / "s" / "version") << kStoreVersion + 1 << "\n";
  std::ofstream(temp.path() / "s" / "x.tmp") << "what a newer one may need";
  const auto before = Contents(temp.path());
  EXPECT_EQ(StoreFolder::Open(temp.path() / "s").status().code(), Code::kVersion);
  EXPECT_EQ(Contents(temp.path()), before);
  std::ofstream(temp.path() / "s" / "version") << "two";
  EXPECT_EQ(StoreFolder::Open(temp.path() / "s").status().code(), Code::kCorrupt);
}

// coordinator/store/testdata/store_1 was written before files had checksum trailers: to quarantine them as
// damaged would lose the jobs.
TEST(StoreFolder, OneFromBeforeThereWereTrailersIsRefusedAndNotTouched) {
  TempFolder temp;
  fs::copy(fs::path(CAIRN_SOURCE_DIR) / "coordinator/store/testdata/store_1", temp.path(),
           fs::copy_options::recursive);
  const auto before = Contents(temp.path());
  ASSERT_GE(before.size(), 8u);
  const Status status = StoreFolder::Open(temp.path() / "store").status();
  EXPECT_EQ(status.code(), Code::kVersion);
  EXPECT_NE(status.message().find("no checksum trailers"), std::string::npos) << status.message();
  EXPECT_EQ(Contents(temp.path()), before);
}

// A folder called `uploads` is nothing rare.
TEST(StoreFolder, AFolderThatHoldsSomethingElseIsRefusedAndNotTouched) {
  TempFolder temp;
  const fs::path folder = temp.path() / "home";
  for (const char* below : {"uploads", "blobs", "checkpoints/thesis"}) fs::create_directories(folder / below);
  std::ofstream(folder / "uploads" / "1.part") << "mine";
  std::ofstream(folder / "blobs" / "86c939568204c39f723a34a4e9b96aef.h5") << "mine";
  std::ofstream(folder / "checkpoints" / "thesis" / "1.h5") << "mine";
  const auto before = Contents(folder);
  const Status status = StoreFolder::Open(folder).status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_NE(status.message().find("no store"), std::string::npos) << status.message();
  EXPECT_EQ(Contents(folder), before);
  EXPECT_FALSE(fs::exists(folder / "lock"));
}

// A moment after the first of two began, which has its lock and some of its folders but no version yet.
TEST(StoreFolder, OneThatAnotherProcessIsMakingIsInUse) {
  TempFolder temp;
  const auto first = StoreFolder::Open(temp.path() / "s");
  ASSERT_TRUE(first.ok());
  fs::remove(first.value().VersionFile());
  EXPECT_EQ(StoreFolder::Open(temp.path() / "s").status().code(), Code::kBusy);
}

// In a container it may have the number that the one before had.
TEST(StoreFolder, OneThatAProcessWithThisNumberBeganIsNoForeignFolder) {
  TempFolder temp;
  fs::create_directories(temp.path() / "s");
  const std::string begun = ".cairn-version." + std::to_string(::getpid()) + "-0.tmp";
  std::ofstream(temp.path() / "s" / begun) << "3";
  ASSERT_TRUE(StoreFolder::Open(temp.path() / "s").ok());
}

TEST(StoreFolder, WhatIsNotTheStoresStaysInIt) {
  TempFolder temp;
  ASSERT_TRUE(StoreFolder::Open(temp.path() / "s").ok());
  std::ofstream(temp.path() / "s" / "uploads" / "notes.txt") << "mine";
  std::ofstream(temp.path() / "s" / "uploads" / "3.part") << "half an upload";
  std::ofstream(temp.path() / "s" / "thesis.txt") << "mine";
  fs::create_directory(temp.path() / "elsewhere");
  std::ofstream(temp.path() / "elsewhere" / "thesis.txt") << "mine";
  Result<StoreFolder> folder = StoreFolder::Open(temp.path() / "s");
  ASSERT_TRUE(folder.ok());
  EXPECT_TRUE(fs::exists(temp.path() / "s" / "uploads" / "notes.txt"));
  EXPECT_FALSE(fs::exists(temp.path() / "s" / "uploads" / "3.part"));
  fs::remove_all(temp.path() / "s" / "blobs");
  fs::create_directory_symlink(temp.path() / "elsewhere", temp.path() / "s" / "blobs");
  ASSERT_TRUE(folder.value().Clear().ok());
  EXPECT_TRUE(fs::exists(temp.path() / "s" / "thesis.txt"));
  EXPECT_TRUE(fs::exists(temp.path() / "elsewhere" / "thesis.txt"));
  EXPECT_FALSE(fs::is_symlink(temp.path() / "s" / "blobs"));
}

TEST(StoreFolder, SeesThatItWasMovedOrRemoved) {
  TempFolder temp;
  const Result<StoreFolder> folder = StoreFolder::Open(temp.path() / "s");
  ASSERT_TRUE(folder.ok());
  EXPECT_TRUE(folder.value().IsStillThere().ok());
  fs::rename(temp.path() / "s", temp.path() / "moved");
  EXPECT_EQ(folder.value().IsStillThere().code(), Code::kIo);
  ASSERT_TRUE(StoreFolder::Open(temp.path() / "s").ok()) << "another one of that name";
  EXPECT_EQ(folder.value().IsStillThere().code(), Code::kIo);
  fs::remove_all(temp.path() / "s");
  fs::rename(temp.path() / "moved", temp.path() / "s");
  EXPECT_TRUE(folder.value().IsStillThere().ok());
}

TEST(StoreFolder, SeesThatALinkCameInItsPlaceOrInOneOfItsFolders) {
  TempFolder temp;
  const fs::path dir = temp.path() / "s", moved = temp.path() / "moved";
  const Result<StoreFolder> folder = StoreFolder::Open(dir);
  ASSERT_TRUE(folder.ok());
  const auto expect_seen = [&](const fs::path& name) {
    fs::rename(name, moved);
    fs::create_directory_symlink(moved, name);
    const Status status = folder.value().MayWriteCheckpoints("job");
    EXPECT_FALSE(status.ok()) << name;
    EXPECT_NE(status.message().find(" link"), std::string::npos) << status.message();
    fs::remove(name);
    fs::rename(moved, name);
    EXPECT_TRUE(folder.value().MayWriteCheckpoints("job").ok()) << name;
  };
  expect_seen(dir);
  fs::create_directory(folder.value().Checkpoints() / "job");
  for (const char* own : {"blobs", "checkpoints", "uploads", "checkpoints/job"}) expect_seen(dir / own);
}

// A service's user may well say where his store lies by a link.
TEST(StoreFolder, BehindALinkThatWasThereBeforeItIsStillThere) {
  TempFolder temp;
  fs::create_directory(temp.path() / "disk");
  fs::create_directory_symlink(temp.path() / "disk", temp.path() / "s");
  const Result<StoreFolder> folder = StoreFolder::Open(temp.path() / "s");
  ASSERT_TRUE(folder.ok()) << folder.status().message();
  EXPECT_TRUE(folder.value().IsStillThere().ok()) << folder.value().IsStillThere().message();
}

TEST(StoreFolder, OneOfVersion1WithTrailersIsUpgraded) {
  TempFolder temp;
  const fs::path store = temp.path() / "s";
  fs::create_directories(store / "checkpoints" / "a");
  std::ofstream(store / "jobs.sqlite") << "";
  std::ofstream(store / "checkpoints" / "a" / "1.h5") << std::string(1000, 'x');  // damaged
  ASSERT_TRUE(WriteCheckpoint(store / "checkpoints" / "a" / "3.h5", SomeCheckpoint()).ok());
  ASSERT_TRUE(StoreFolder::Open(store).ok());
  EXPECT_TRUE(fs::exists(store / "version"));
  fs::remove(store / "checkpoints" / "a" / "3.h5");
  EXPECT_TRUE(StoreFolder::Open(store).ok())
      << "damaged files are no reason to refuse a store that says its version";
}

TEST(StoreFolder, ClearForgetsJobsAndKeepsTheLock) {
  TempFolder temp;
  auto folder = StoreFolder::Open(temp.path() / "s");
  ASSERT_TRUE(folder.ok());
  fs::create_directories(folder.value().Checkpoints() / "a");
  ASSERT_TRUE(WriteCheckpoint(folder.value().CheckpointFile("a", 3), SomeCheckpoint()).ok());
  EXPECT_EQ(folder.value().CheckpointNumbers("a"), std::vector<std::uint64_t>{3});
  EXPECT_EQ(folder.value().JobsWithCheckpoints(), std::vector<std::string>{"a"});
  ASSERT_TRUE(folder.value().Clear().ok());
  EXPECT_TRUE(folder.value().JobsWithCheckpoints().empty());
  EXPECT_TRUE(fs::exists(folder.value().dir() / "lock"));
}

TEST(Recovery, OfTheCheckpointBeforeOnlyBlobsThatAreThereAreKept) {
  TempFolder temp;
  auto folder = StoreFolder::Open(temp.path() / "s");
  fs::create_directories(folder.value().Checkpoints() / "a");
  const wire::NamedBlob b = TextBlob("b"), c = TextBlob("c");
  for (const wire::NamedBlob& named : {b, c})
    ASSERT_TRUE(WriteBlobFile(folder.value().BlobFile(named.hash), "blob", *named.blob).ok());
  ASSERT_TRUE(WriteCheckpoint(folder.value().CheckpointFile("a", 3), SomeCheckpoint()).ok());
  proto::Checkpoint before = SomeCheckpoint();  // its removal did not outlive a power cut, its blob's did
  before.set_number(2);
  before.add_blobs(c.hash.Binary());
  before.add_blobs(TextBlob("gone").hash.Binary());
  ASSERT_TRUE(WriteCheckpoint(folder.value().CheckpointFile("a", 2), before).ok());
  BlobFiles files(folder.value());
  const auto jobs = Recover(folder.value(), files, InputsOf::kStore, {},
                            [](Severity, const std::string&, const std::string&) {});
  ASSERT_EQ(jobs.size(), 1u);
  EXPECT_EQ(jobs[0].checkpoint.number(), 3u);
  EXPECT_EQ(jobs[0].previous_blobs, (std::vector{b.hash, c.hash}));
}

// Of a job, with its blob, and one more that nothing names.
struct SavedJob {
  SavedJob() {
    fs::create_directories(folder.value().Checkpoints() / "a");
    for (const wire::NamedBlob& named : {b, other})
      EXPECT_TRUE(WriteBlobFile(folder.value().BlobFile(named.hash), "blob", *named.blob).ok());
    EXPECT_TRUE(WriteCheckpoint(folder.value().CheckpointFile("a", 3), SomeCheckpoint()).ok());
  }
  std::size_t Recovered() {
    BlobFiles files(folder.value());
    return Recover(folder.value(), files, InputsOf::kStore, {},
                   [](Severity, const std::string&, const std::string&) {})
        .size();
  }
  TempFolder temp;
  Result<StoreFolder> folder = StoreFolder::Open(temp.path() / "s");
  const wire::NamedBlob b = TextBlob("b"), other = TextBlob("other");
};

// As of a disk that fails for a moment: a folder where the file was. What is there is not known.
TEST(Recovery, WhatCannotBeReadAndMayBeWholeIsNeitherQuarantinedNorRemoved) {
  for (const bool checkpoint : {false, true}) {
    SavedJob saved;
    const fs::path file = checkpoint ? saved.folder.value().CheckpointFile("a", 3)
                                     : saved.folder.value().BlobFile(saved.b.hash);
    const fs::path aside = saved.temp.path() / "aside";
    fs::rename(file, aside);
    fs::create_directory(file);
    EXPECT_THROW(saved.Recovered(), UnreadableStore);
    fs::remove(file);
    fs::rename(aside, file);
    EXPECT_EQ(saved.Recovered(), 1u) << "nothing was lost";
    EXPECT_FALSE(fs::exists(saved.folder.value().BlobFile(saved.other.hash))) << "what nothing names goes";
  }
}

TEST(Recovery, WhereACheckpointIsDamagedNoBlobIsRemoved) {
  SavedJob saved;
  std::ofstream(saved.folder.value().CheckpointFile("a", 3)) << "damaged";
  for (int start = 0; start < 2; ++start) {
    EXPECT_EQ(saved.Recovered(), 0u);
    EXPECT_TRUE(fs::exists(saved.folder.value().BlobFile(saved.b.hash))) << "it may be a log of the user's";
  }
}

// Whoever submitted it has the input still; a job that is gone without a word he would wait for.
TEST(Recovery, AJobWhoseInputIsDamagedHasFailedAndSaysWhich) {
  SavedJob saved;
  proto::Checkpoint checkpoint = SomeCheckpoint();
  (*checkpoint.mutable_job()->mutable_input_blobs())["log"] = saved.b.hash.Binary();
  ASSERT_TRUE(WriteCheckpoint(saved.folder.value().CheckpointFile("a", 3), checkpoint).ok());
  std::ofstream(saved.folder.value().BlobFile(saved.b.hash)) << "damaged";
  for (int start = 0; start < 2; ++start) {
    BlobFiles files(saved.folder.value());
    const std::vector<RestoreJob> jobs =
        Recover(saved.folder.value(), files, InputsOf::kStore, {}, [](auto, const auto&, const auto&) {});
    ASSERT_EQ(jobs.size(), 1u) << "start " << start;
    EXPECT_EQ(jobs[0].checkpoint.state(), proto::JOB_FAILED);
    EXPECT_NE(jobs[0].checkpoint.reason().find("'log' is damaged or gone"), std::string::npos)
        << jobs[0].checkpoint.reason();
    EXPECT_FALSE(files.Has(saved.b.hash));
  }
}

// As by a copy to the wrong folder.
TEST(Recovery, ACheckpointOfAnotherJobIsNamedAndNotUsed) {
  SavedJob saved;
  fs::rename(saved.folder.value().Checkpoints() / "a", saved.folder.value().Checkpoints() / "b");
  const std::string what = saved.folder.value().CheckpointFile("b", 3).string() + ": is of job 'a'";
  const StoreFindings found = CheckStore(saved.folder.value(), saved.temp.path() / "results", false);
  EXPECT_EQ(found.damaged, std::vector<std::string>{"job b: " + what});
  BlobFiles files(saved.folder.value());
  std::string said;
  EXPECT_TRUE(Recover(saved.folder.value(), files, InputsOf::kStore, {},
                      [&said](Severity, const std::string&, const std::string& text) { said += text + "\n"; })
                  .empty());
  EXPECT_NE(said.find(what), std::string::npos) << said;
  EXPECT_EQ(said.find("blobs"), std::string::npos) << said;
}

// As by a mount: each would remove the blobs of which only the other knows.
TEST(StoreFolder, OneWhoseBlobsAreThoseOfAnotherIsRefused) {
  const TempFolder temp;
  {
    ASSERT_TRUE(StoreFolder::Open(temp.path() / "s").ok());
  }
  const int other = ::open((temp.path() / "s/blobs").c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(other, LOCK_EX | LOCK_NB), 0);
  for (auto* open : {&StoreFolder::Open, &StoreFolder::OpenAsItIs}) {
    const Status refused = open(temp.path() / "s").status();
    EXPECT_EQ(refused.code(), Code::kBusy);
    EXPECT_NE(refused.message().find("blobs is in use by another store"), std::string::npos)
        << refused.message();
  }
  ::close(other);
  StoreFolder folder = StoreFolder::Open(temp.path() / "s").value();
  ASSERT_TRUE(folder.Clear().ok());
  const int late = ::open(folder.Blobs().c_str(), O_RDONLY | O_DIRECTORY);
  EXPECT_NE(::flock(late, LOCK_EX | LOCK_NB), 0) << "the new folder of blobs is locked too";
  ::close(late);
}

TEST(StoreFolder, OneWhoseBlobsAreNotMountedIsRefusedAndNotTouched) {
  SavedJob saved;
  const fs::path store = saved.temp.path() / "s", away = saved.temp.path() / "away";
  {
    const StoreFolder closed = std::move(saved.folder).value();
  }
  fs::rename(store / "blobs", away);
  const Status refused = StoreFolder::Open(store).status();
  EXPECT_EQ(refused.code(), Code::kCorrupt);
  EXPECT_NE(refused.message().find("not mounted"), std::string::npos) << refused.message();
  EXPECT_FALSE(fs::exists(store / "blobs"));
  fs::rename(away, store / "blobs");
  EXPECT_TRUE(StoreFolder::Open(store).ok());
}

TEST(JobTable, RemembersTheHighestNumberThatAJobHad) {
  TempFolder temp;
  {
    auto table = JobTable::Open(temp.path() / "jobs.sqlite");
    ASSERT_TRUE(table.ok()) << table.status().message();
    EXPECT_EQ(table.value().LastNumber(), 0U);
    for (const char* id : {"1-a", "9-b", "3-c", "no-number"}) ASSERT_TRUE(table.value().NoteNumber(id).ok());
    EXPECT_EQ(table.value().LastNumber(), 9U);
  }
  EXPECT_EQ(JobTable::Open(temp.path() / "jobs.sqlite").value().LastNumber(), 9U);
}

TEST(JobTable, OneOfVersion1IsUpgradedWithTheNumbersOfItsRows) {
  TempFolder temp;
  fs::copy(fs::path(CAIRN_SOURCE_DIR) / "coordinator/store/testdata/store_1/store/jobs.sqlite", temp.path());
  for (int i = 0; i < 2; ++i) {
    auto table = JobTable::Open(temp.path() / "jobs.sqlite");
    ASSERT_TRUE(table.ok()) << table.status().message();
    EXPECT_EQ(table.value().LastNumber(), 3u);
  }
}

TEST(JobTable, ANewerOneIsRefusedAndNotTouched) {
  TempFolder temp;
  ASSERT_TRUE(JobTable::Open(temp.path() / "jobs.sqlite").ok());
  {
    std::fstream file(temp.path() / "jobs.sqlite", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(60 + 3);  // the last byte of user_version, https://sqlite.org/fileformat.html
    file.put(100);
  }
  const auto before = Contents(temp.path());
  const Status status = JobTable::Open(temp.path() / "jobs.sqlite").status();
  EXPECT_EQ(status.code(), Code::kVersion) << status.message();
  EXPECT_EQ(Contents(temp.path()), before);
}

TEST(JobTable, RemembersTheHighestNumberThatWasRemoved) {
  TempFolder temp;
  {
    auto table = JobTable::Open(temp.path() / "jobs.sqlite");
    for (const char* id : {"3-a", "12-b", "7-c", "no-number"}) {
      ASSERT_TRUE(table.value().NoteRemoval(id).ok());
      ASSERT_TRUE(table.value().Remove(id).ok());
    }
  }
  EXPECT_EQ(JobTable::Open(temp.path() / "jobs.sqlite").value().LastNumber(), 12u);
}

TEST(JobTable, AFileThatIsNoTableIsCorrupt) {
  TempFolder temp;
  std::ofstream(temp.path() / "jobs.sqlite") << std::string(4096, 'x');
  EXPECT_EQ(JobTable::Open(temp.path() / "jobs.sqlite").status().code(), Code::kCorrupt);
}

TEST(JobYaml, IsAJobFile) {
  proto::Job job;
  job.set_name("a \"name\"");
  job.set_seed(7);
  (*job.mutable_inputs())["log"] = "dir/log.h5";
  proto::Stage& stage = *job.add_stages();
  stage.set_name("map");
  stage.set_pipeline("landmark_map");
  (*stage.mutable_inputs())["log"] = "log";
  (*stage.mutable_options())["cell_m"].set_d(1);
  (*stage.mutable_options())["count"].set_i(-3);
  (*stage.mutable_options())["sharp"].set_b(true);
  (*stage.mutable_options())["mode"].set_s("fast\n");
  EXPECT_EQ(
      JobAsYaml(job),
      "name: \"a \\\"name\\\"\"\nseed: 7\ninputs:\n  log: \"dir/log.h5\"\nstages:\n  - name: \"map\"\n"
      "    pipeline: \"landmark_map\"\n    log: \"log\"\n    options:\n      cell_m: 1.0\n      count: -3\n"
      "      mode: \"fast\\x0a\"\n      sharp: true\n");
}

}  // namespace
}  // namespace cairn::coordinator
