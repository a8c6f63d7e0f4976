// Long, for all of it needs one fixture: a store with a job that is held in the midst of a round.
#include "coordinator/store/backup.h"

#include <signal.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/cleaner.h"
#include "coordinator/store/job_table.h"
#include "coordinator/store/recovery.h"
#include "coordinator/store/store_id.h"
#include "coordinator/store/testing/open_and_serve.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

// A store with a job in its second round, held there; with many tasks, so that there are packs.
class Backup : public ::testing::Test {
 protected:
  void SetUp() override {
    // Where a service has them.
    fs::create_directories(fixture_.temp.path() / "results");
    fs::create_directory_symlink(fixture_.temp.path() / "results", From() / "results");
    fixture_.transport.tasks = 20;
    fixture_.transport.swallow = [](const wire::Assign& assign) {
      return assign.key().kind() == wire::TaskKey::ADVANCE && assign.key().round() == 1;
    };
    fixture_.Submit();
    fixture_.transport.ComeWorker("w");
    fixture_.Until([&] {
      const auto numbers = Store().CheckpointNumbers("a");
      if (numbers.empty()) return false;
      const auto saved = ReadCheckpoint(Store().CheckpointFile("a", numbers.back()));
      return saved.ok() && saved.value().round() == 1;
    });
    // Its partials are saved, too; then there is nothing more to save.
    int quiet = 0;
    fixture_.Until([&] {
      quiet = fixture_.server->core().HasUnsaved() ? 0 : quiet + 1;
      return quiet == 300;
    });
    fixture_.Until([&] { return !JobTable::JobsWithLogIn(Store().JobTable()).value().empty(); });
  }
  // Nobody writes any more.
  void Stop() {
    fixture_.server.reset();
    fixture_.folder.reset();
  }
  const StoreFolder& Store() const { return *fixture_.folder; }
  // A job that was cancelled, and left no log.
  void PutCancelled(const std::string& job) {
    proto::Checkpoint cancelled;
    cancelled.set_job_id(job);
    cancelled.set_number(1);
    *cancelled.mutable_job() = fixture_.MakeJob();
    cancelled.set_state(proto::JOB_CANCELLED);
    fs::create_directories(Store().Checkpoints() / job);
    ASSERT_TRUE(WriteCheckpoint(Store().CheckpointFile(job, 1), cancelled).ok());
  }
  fs::path From() const { return fixture_.temp.path() / "store"; }
  fs::path To() const { return fixture_.temp.path() / "copy"; }
  BackupFacts Copied() const {
    Result<BackupFacts> facts = BackUp(From(), To());
    EXPECT_TRUE(facts.ok()) << facts.status().message();
    return facts.ok() ? facts.value() : BackupFacts();
  }
  // Of the log of the job.
  static std::size_t LinesOf(const fs::path& store) {
    const Result<JobTable> table = JobTable::Open(StoreFolder::LookAt(store).value().JobTable());
    return table.ok() ? table.value().ReadLog("a", 0).value().size() : 0;
  }
  bool IsWhole() const { return fs::exists(To() / kBackupMark); }
  // By another worker, for the first keeps its task.
  void GoOn() {
    fixture_.transport.swallow = [](const wire::Assign&) { return false; };
    wire::Message leave;
    leave.envelope.mutable_leave();
    fixture_.transport.Come("w", std::move(leave));
    fixture_.transport.ComeWorker("another");
  }
  static std::set<fs::path> Tree(const fs::path& dir) {
    std::set<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dir))
      if (entry.is_regular_file()) files.insert(fs::relative(entry.path(), dir));
    return files;
  }

  ServerFixture fixture_;
};

TEST_F(Backup, OfAStoreThatIsServedIsAStoreInWhichTheJobGoesOn) {
  EXPECT_EQ(Copied().jobs, 1U);
  EXPECT_TRUE(IsWhole());
  Stop();
  const std::set<fs::path> before = Tree(From());
  EXPECT_EQ(Copied().jobs, 1U);
  EXPECT_EQ(Tree(From()), before) << "nothing is written there";
  fs::remove_all(From());
  fixture_.store_dir = To();
  fixture_.transport.swallow = [](const wire::Assign&) { return false; };
  fixture_.Start();
  EXPECT_EQ(fixture_.server->core().Find("a")->round(), 1U);
  fixture_.transport.ComeWorker("w");
  fixture_.Until([&] { return fixture_.State() == "done"; });
}

TEST_F(Backup, OverAnEarlierOneCopiesWhatIsNewAndRemovesWhatNobodyNeeds) {
  EXPECT_GT(Copied().files, 1U);
  EXPECT_EQ(Copied().files, 0U);
  GoOn();
  fixture_.Until([&] { return fixture_.State() == "done"; });
  EXPECT_GT(Copied().files, 0U);
  EXPECT_TRUE(StoreFolder::LookAt(To()).value().PackFiles().empty()) << "a job that is done needs none";
  EXPECT_EQ(StoreFolder::LookAt(To()).value().CheckpointNumbers("a").size(), 1U);
}

TEST_F(Backup, WhileJobsRunEachIsWhole) {
  fixture_.transport.rounds = 200;
  GoOn();
  std::atomic<bool> over = false;
  std::vector<std::string> damaged;
  std::size_t copies = 0;
  std::thread copier([&] {
    for (; !over; ++copies)
      for (const std::string& what : Copied().damaged) damaged.push_back(what);
  });
  fixture_.Until([&] { return fixture_.State() == "done"; });
  over = true;
  copier.join();
  EXPECT_EQ(damaged, std::vector<std::string>());
  EXPECT_GT(copies, 0U);
}

TEST_F(Backup, WhatIsDamagedIsSaidAndTheCopyKeepsWhatItHad) {
  Copied();
  const std::set<fs::path> whole = Tree(To());
  // The next checkpoint is none.
  const std::uint64_t next = Store().CheckpointNumbers("a").back() + 1;
  std::ofstream(Store().CheckpointFile("a", next)) << "no checkpoint";
  const BackupFacts facts = Copied();
  ASSERT_EQ(facts.damaged.size(), 1U);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "job a: ", facts.damaged[0]);
  EXPECT_FALSE(IsWhole());
  std::set<fs::path> kept = Tree(To());
  kept.insert(kBackupMark);
  EXPECT_EQ(kept, whole);
}

// An earlier copy stays, whose lines are whole; a first one, as a store that is restored, is made without
// them.
TEST_F(Backup, DamagedLinesOfALogAreSaidAndNotCopied) {
  Copied();
  const std::size_t lines = LinesOf(To());
  ASSERT_GT(lines, 0U);
  Stop();
  const auto execute = [&](const char* sql) {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(StoreFolder::LookAt(From()).value().JobTable().c_str(), &db), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(db, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
    sqlite3_close(db);
  };
  execute("UPDATE log SET text = CAST(x'61ff' AS TEXT) WHERE number = 1;");
  const BackupFacts again = Copied();
  ASSERT_EQ(again.damaged.size(), 1U);
  EXPECT_PRED_FORMAT2(testing::IsSubstring,
                      "damaged lines: 1, of job 'a' for one; start the coordinator again", again.damaged[0]);
  EXPECT_EQ(LinesOf(To()), lines);
  EXPECT_FALSE(IsWhole());
  const fs::path first = fixture_.temp.path() / "first";
  EXPECT_EQ(BackUp(From(), first).value().damaged.size(), 1U);
  EXPECT_EQ(LinesOf(first), lines - 1);
}

TEST_F(Backup, AStoreWithoutJobsTakesNoCopyAway) {
  Copied();
  TempFolder other;
  {
    ASSERT_TRUE(StoreFolder::Open(other.path() / "store").ok());
  }
  EXPECT_EQ(BackUp(other.path() / "store", To()).status().code(), Code::kRefused) << "is it the right store?";
  EXPECT_TRUE(IsWhole());
  EXPECT_EQ(BackUp(other.path() / "none", To()).status().code(), Code::kNotFound);
  EXPECT_EQ(BackUp(To(), From()).status().code(), Code::kRefused) << "a store is nobody's copy";
  EXPECT_FALSE(fs::exists(other.path() / "none"));
}

TEST_F(Backup, AStoreOfItsOwnIsNoPlaceForOne) {
  TempFolder other;
  {
    ASSERT_TRUE(OpenAndServe(other.path() / "store", false).ok());
  }
  EXPECT_EQ(BackUp(From(), other.path() / "store").status().code(), Code::kRefused);
  Copied();
  fs::rename(From(), fixture_.temp.path() / "moved");
  EXPECT_EQ(BackUp(fixture_.temp.path() / "moved", To()).status().code(), Code::kRefused)
      << "of another store";
  fs::rename(fixture_.temp.path() / "moved", From());
  EXPECT_EQ(BackUp(From(), From() / "copy").status().code(), Code::kRefused);
  EXPECT_EQ(BackUp(From(), From()).status().code(), Code::kRefused);
}

TEST_F(Backup, OneThatEndedAtItsBeginningIsInNobodysWay) {
  {
    ASSERT_TRUE(StoreFolder::Open(To()).ok());
  }
  ASSERT_TRUE(fs::exists(To() / "version"));
  EXPECT_EQ(Copied().jobs, 1U);
  EXPECT_TRUE(IsWhole());
  const fs::path mine = fixture_.temp.path() / "mine";
  {
    ASSERT_TRUE(StoreFolder::Open(mine).ok());
  }
  std::ofstream(mine / "blobs" / "thesis.tex") << "text";
  EXPECT_EQ(BackUp(From(), mine).status().code(), Code::kRefused);
}

// The system ends whoever writes the largest file of all, so that some are there and others are not.
TEST_F(Backup, ARestoreThatIsKilledIsServedByNobodyAndTheSameAgainGoesOn) {
  Stop();
  Copied();
  std::uintmax_t largest = 0;
  for (const fs::path& path : Tree(To())) largest = std::max(largest, fs::file_size(To() / path));
  const fs::path back = fixture_.temp.path() / "back";
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_DFL);
    const rlimit limit{largest - 1, largest - 1};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    static_cast<void>(RestoreStore(To(), back));
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it was done before";
  const std::string goes_on = "`cairn restore " + To().string() + " --store " + back.string() + "` goes on";
  const Status served = OpenAndServe(back, true).status();
  EXPECT_EQ(served.code(), Code::kRefused);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, goes_on, served.message());
  fs::copy(To(), fixture_.temp.path() / "other", fs::copy_options::recursive);
  const Status other = RestoreStore(fixture_.temp.path() / "other", back).status();
  EXPECT_EQ(other.code(), Code::kRefused);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, goes_on, other.message());
  const Result<BackupFacts> facts = RestoreStore(To(), back);
  ASSERT_TRUE(facts.ok()) << facts.status().message();
  EXPECT_EQ(facts.value().jobs, 1U);
  std::set<fs::path> whole = Tree(To());
  for (const char* mark : {kBackupMark, kBackupOf}) EXPECT_EQ(whole.erase(mark), 1U);
  whole.insert("id");
  EXPECT_EQ(Tree(back), whole);
  EXPECT_EQ(RestoreStore(To(), back).status().code(), Code::kRefused) << "it is a store of its own now";
  EXPECT_TRUE(OpenAndServe(back, false).ok());
}

TEST_F(Backup, WhatHasLostItsCheckpointsIsNotTakenForDeleted) {
  Copied();
  const std::set<fs::path> whole = Tree(To());
  fs::create_directories(fixture_.temp.path() / "results" / "a");
  fs::rename(Store().Checkpoints() / "a", fixture_.temp.path() / "lost");
  fs::create_directories(Store().Checkpoints() / "b");
  std::ofstream(Store().CheckpointFile("b", 1)) << "no checkpoint";
  const BackupFacts facts = Copied();
  EXPECT_EQ(facts.damaged.size(), 2U);
  EXPECT_EQ(facts.jobs, 0U);
  for (const fs::path& path : whole) EXPECT_EQ(fs::exists(To() / path), path != kBackupMark) << path;
}

TEST_F(Backup, ACheckFindsWhatHasRottedAndCopiesItAnew) {
  Stop();
  Copied();
  const Hash log = TextBlob("the log").hash;
  const StoreFolder copy = StoreFolder::LookAt(To()).value();
  const fs::path blob = fs::exists(copy.FlatFile(log)) ? copy.FlatFile(log) : copy.BlobFile(log);
  ASSERT_TRUE(fs::exists(blob));
  {
    std::fstream(blob, std::ios::in | std::ios::out).seekp(100) << "rot";
  }
  EXPECT_EQ(Copied().files, 0U) << "it looks at names alone";
  EXPECT_FALSE(CheckBlobAlone(copy, log).ok());
  const Result<BackupFacts> checked = BackUp(From(), To(), true);
  ASSERT_TRUE(checked.ok());
  EXPECT_EQ(checked.value().files, 1U);
  EXPECT_TRUE(CheckBlobAlone(copy, log).ok());
}

TEST_F(Backup, OfAResultThatIsDamagedTheCopyStays) {
  fixture_.transport.swallow = [](const wire::Assign&) { return false; };
  GoOn();
  fixture_.Until([&] { return fixture_.State() == "done"; });
  Stop();
  Copied();
  const fs::path result = *fs::directory_iterator(From() / "results" / "a");
  const fs::path copy = To() / "results" / "a" / result.filename();
  ASSERT_TRUE(ReadBlobFile(copy).ok());
  const auto size = fs::file_size(result);
  {
    std::fstream(result, std::ios::in | std::ios::out).seekp(static_cast<std::streamoff>(size) / 2) << "rot";
  }
  EXPECT_EQ(Copied().damaged, std::vector<std::string>()) << "it looks at sizes and trailers alone";
  const Result<BackupFacts> checked = BackUp(From(), To(), true);
  ASSERT_TRUE(checked.ok());
  ASSERT_EQ(checked.value().damaged.size(), 1U);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, result.filename().string() + ", as it was copied",
                      checked.value().damaged[0]);
  EXPECT_TRUE(ReadBlobFile(copy).ok()) << "the last good one";
  fs::resize_file(result, size - 1);
  EXPECT_EQ(Copied().damaged.size(), 1U);
  EXPECT_TRUE(ReadBlobFile(copy).ok()) << "the last good one";
}

TEST_F(Backup, APackThatHasRottedIsCopiedAnew) {
  Stop();
  Copied();
  const StoreFolder copy = StoreFolder::LookAt(To()).value();
  ASSERT_FALSE(copy.PackFiles().empty());
  const fs::path pack = copy.PackFiles().front();
  {
    std::fstream(pack, std::ios::in | std::ios::out).seekp(1000) << "rot";
  }
  ASSERT_FALSE(HashesInPack(pack));
  const Result<BackupFacts> checked = BackUp(From(), To(), true);
  ASSERT_TRUE(checked.ok());
  EXPECT_EQ(checked.value().damaged, std::vector<std::string>());
  EXPECT_EQ(checked.value().files, 1U);
  EXPECT_TRUE(HashesInPack(pack));
  EXPECT_TRUE(IsWhole());
  const fs::path there = From() / "blobs" / pack.filename();
  for (const fs::path& rotten : {there, pack})
    std::fstream(rotten, std::ios::in | std::ios::out).seekp(1000) << "rot";
  const BackupFacts damaged = Copied();
  ASSERT_EQ(damaged.damaged.size(), 1U);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, there.string() + ", as it was copied, is damaged",
                      damaged.damaged[0]);
}

// A coordinator served it.
void Serve(const fs::path& store) { ASSERT_TRUE(OpenAndServe(store, false).ok()) << store; }

void ExpectRefused(const fs::path& from, const fs::path& to, const std::string& why) {
  const Status status = BackUp(from, to).status();
  EXPECT_EQ(status.code(), Code::kRefused) << from << " to " << to;
  EXPECT_PRED_FORMAT2(testing::IsSubstring, why, status.message());
}

// It lies where the one lay that the copy is of.
TEST_F(Backup, AnotherStoreInTheSamePlaceTakesNoCopyAway) {
  Stop();
  Serve(From());
  Copied();
  const std::set<fs::path> whole = Tree(To());
  fs::rename(From(), fixture_.temp.path() / "lost");
  Serve(From());
  fs::copy(fixture_.temp.path() / "lost" / "checkpoints" / "a", From() / "checkpoints" / "b",
           fs::copy_options::recursive);
  ExpectRefused(From(), To(), "is a backup of another store than this one, that was at " + From().string());
  EXPECT_EQ(Tree(To()), whole);
  EXPECT_TRUE(BackUp(fixture_.temp.path() / "lost", To()).ok()) << "it was moved, and is the same";
}

// Of a backup of an earlier Cairn the place alone tells whose it is, unless the store that is there now was
// new when it was first served.
TEST_F(Backup, ANewStoreInTheSamePlaceTakesNoCopyWithoutAnIdAway) {
  Stop();
  Copied();
  const std::set<fs::path> whole = Tree(To());
  fs::rename(From(), fixture_.temp.path() / "lost");
  Serve(From());
  ExpectRefused(From(), To(), "not of this store");
  fs::copy(fixture_.temp.path() / "lost" / "checkpoints" / "a", From() / "checkpoints" / "b",
           fs::copy_options::recursive);
  Serve(From());
  ExpectRefused(From(), To(), "not of this store");
  EXPECT_EQ(Tree(To()), whole);
}

// Two that begin at once may both find it empty: whose it is is asked of a folder that nobody else has.
TEST_F(Backup, WhoseACopyIsIsAskedOnceItIsLocked) {
  Stop();
  Serve(From());
  Copied();
  const fs::path other = fixture_.temp.path() / "other";
  Serve(other);
  {
    const StoreFolder theirs = StoreFolder::Open(To()).value();
    EXPECT_EQ(BackUp(other, To()).status().code(), Code::kBusy);
  }
  ExpectRefused(other, To(), "another store");
}

TEST_F(Backup, AnIdComesWithTheNextServiceAndOneThatWasGivenStays) {
  Stop();
  Copied();
  EXPECT_EQ(ReadBackupOf(To() / kBackupOf).value().id, "");
  Serve(From());
  const std::string id = ReadStoreId(From() / "id").value().id;
  EXPECT_EQ(id.size(), 32U);
  Copied();
  EXPECT_EQ(ReadBackupOf(To() / kBackupOf).value().id, id) << "by its place it was known before";
  ASSERT_TRUE(OpenAndServe(From(), true).ok());
  EXPECT_EQ(ReadStoreId(From() / "id").value().id, id) << "taken over";
  std::ofstream(From() / "id") << "rot";
  ExpectRefused(From(), To(), "another store");
  Serve(From());
  ExpectRefused(From(), To(), "another store");
}

TEST_F(Backup, OfTwoStoresWithOneIdTheCopyStaysItsFirstOnes) {
  Stop();
  Serve(From());
  Copied();
  const fs::path twin = fixture_.temp.path() / "twin";
  fs::copy(From(), twin, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  ExpectRefused(twin, To(), "of which this store is a copy");
  EXPECT_TRUE(BackUp(From(), To()).ok());
}

// Each would remove what the other did.
TEST_F(Backup, AStoreAndTheOneRestoredOfItNeverWriteOverTheSameCopy) {
  Stop();
  Serve(From());
  Copied();
  const fs::path back = fixture_.temp.path() / "back", late = fixture_.temp.path() / "late";
  ASSERT_TRUE(RestoreStore(To(), back).ok());
  ASSERT_TRUE(RestoreStore(To(), late).ok());
  Serve(back);
  EXPECT_TRUE(BackUp(back, To()).ok()) << "it goes on as that store";
  EXPECT_TRUE(BackUp(back, To()).ok());
  ExpectRefused(From(), To(), "another store");
  ExpectRefused(late, To(), "or of that which this one was restored from, copied since");
  const fs::path second = fixture_.temp.path() / "second";
  ASSERT_TRUE(BackUp(From(), second).ok());
  fs::remove_all(late);
  ASSERT_TRUE(RestoreStore(second, late).ok());
  ASSERT_TRUE(BackUp(From(), second).ok()) << "the first of the two";
  ExpectRefused(late, second, "copied since");
}

TEST_F(Backup, IsServedByNobody) {
  Stop();
  Serve(From());
  Copied();
  const std::set<fs::path> whole = Tree(To());
  for (const bool take_over : {false, true}) {
    const Status served = OpenAndServe(To(), take_over).status();
    EXPECT_EQ(served.code(), Code::kRefused);
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "`cairn restore " + To().string() + " --store ANOTHER`",
                        served.message());
  }
  EXPECT_EQ(Tree(To()), whole);
}

// Its folder went with a bad disk, say; the table still has its log.
TEST_F(Backup, KeepsTheJobWhoseCheckpointsAreLost) {
  Copied();
  const std::set<fs::path> whole = Tree(To());
  ASSERT_GT(LinesOf(To()), 0U);
  PutCancelled("b");
  for (const bool with_folder : {true, false}) {
    fs::rename(Store().Checkpoints() / "a", fixture_.temp.path() / ("lost" + std::to_string(with_folder)));
    if (with_folder) fs::create_directories(Store().Checkpoints() / "a");
    const BackupFacts facts = Copied();
    ASSERT_EQ(facts.damaged.size(), 1U);
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "job a is lost", facts.damaged[0]);
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "the copy keeps it as it was", facts.damaged[0]);
    for (const fs::path& path : whole) EXPECT_EQ(fs::exists(To() / path), path != kBackupMark) << path;
    EXPECT_GT(LinesOf(To()), 0U);
  }
}

TEST_F(Backup, KeepsWhatALostTableCannotTellToBeDeleted) {
  Stop();
  Serve(From());
  Copied();
  const StoreFolder store = StoreFolder::LookAt(From()).value();
  const fs::path table = store.JobTable(), job = store.Checkpoints() / "a";
  const auto keeps = [&] {
    const BackupFacts facts = Copied();
    EXPECT_EQ(facts.damaged.empty(), !fs::exists(To() / "checkpoints" / "a"));
    return fs::exists(To() / "checkpoints" / "a");
  };
  fs::rename(job, fixture_.temp.path() / "lost");
  fs::create_directories(job);
  std::ofstream(job / "1.h5.damaged") << "rot";
  fs::remove(table);
  EXPECT_TRUE(keeps()) << "its folder is there";
  fs::remove_all(job);
  EXPECT_TRUE(keeps()) << "the table is not";
  ASSERT_TRUE(OpenJobTable(store, [](Severity, const std::string&) {}).ok());
  EXPECT_FALSE(fs::exists(table.string() + ".damaged")) << "a store without a job had none";
  std::ofstream(table.string() + ".damaged") << "rot";
  EXPECT_TRUE(keeps()) << "it was made anew";
  fs::remove(table.string() + ".damaged");
  EXPECT_FALSE(keeps()) << "what it told was given up";
}

// A job that came between its checkpoints and its table would be one that is lost.
TEST_F(Backup, HasNoLogOfAJobThatItDoesNotHave) {
  Stop();
  {
    Result<JobTable> table = JobTable::Open(StoreFolder::LookAt(From()).value().JobTable());
    ASSERT_TRUE(table.ok());
    wire::LogLine line;
    line.set_utc("2026-01-01T00:00:00Z");
    line.set_level("info");
    line.set_text("submitted");
    ASSERT_TRUE(table.value().AppendLog({{"9-late", {0, {line}}}}).ok());
  }
  Copied();
  const fs::path table = StoreFolder::LookAt(To()).value().JobTable();
  EXPECT_EQ(JobTable::JobsWithLogIn(table).value(), std::vector<std::string>{"a"});
}

TEST_F(Backup, OfAJobThatWasDeletedNothingStays) {
  PutCancelled("b");
  EXPECT_EQ(Copied().jobs, 2U);
  fs::remove_all(Store().Checkpoints() / "b");
  EXPECT_EQ(Copied().jobs, 1U);
  EXPECT_EQ(StoreFolder::LookAt(To()).value().JobsWithCheckpoints(), std::vector<std::string>{"a"});
}

}  // namespace
}  // namespace cairn::coordinator
