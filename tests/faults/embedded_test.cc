// RunEmbedded with real worker processes: what `cairn run` stands on.
#include "coordinator/local/embedded.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipelines/testing/in_process.h"
#include "schema/store/blob_file.h"
#include "schema/wire/testing/private_folder.h"
#include "worker/testing/toy_pipeline.h"

namespace cairn::faults {
namespace {

namespace fs = std::filesystem;
using coordinator::EmbeddedEnd;
using coordinator::EmbeddedOptions;
using coordinator::EmbeddedProgress;
using coordinator::EmbeddedResult;

// Processes that this thread started.
std::vector<pid_t> Children() {
  const std::string pid = std::to_string(::getpid());
  std::ifstream in("/proc/" + pid + "/task/" + pid + "/children");
  return {std::istream_iterator<pid_t>(in), {}};
}

class Embedded : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("CAIRN_TASK_MS", "1", 1);
    log_ = std::make_shared<const Blob>(testing::ToyLog(50).Without("truth/"));
    proto::Stage& stage = *job_.add_stages();
    stage.set_name("toy");
    stage.set_pipeline("toy");
    (*stage.mutable_inputs())["log"] = "log";
    SetOption("rounds", 20);
    options_.dir = (folder_.path() / "out").string();
    options_.workers = 2;
    options_.worker_program = CAIRN_FAULTS_WORKER;
    options_.checkpoint_interval_s = 0;
    options_.save_patience_s = 60;  // what is claimed here holds however slow the disk is
    options_.log = [this](coordinator::Severity, const std::string& line) { lines_ += line + "\n"; };
  }
  void SetOption(const std::string& name, std::int64_t value) {
    (*job_.mutable_stages(0)->mutable_options())[name].set_i(value);
  }
  EmbeddedResult Run() {
    return RunEmbedded(
        options_, job_, {{"log", log_}}, [this](const EmbeddedProgress& p) { on_progress_(p); }, stop_);
  }
  Hash Want() const {
    return RunInProcess(*testing::MakeToy(job_.stages(0), 0), {{"log", log_}})->ContentHash();
  }
  Hash Have() const {
    const auto file =
        ReadBlobFile(fs::path(options_.dir) / "toy.h5", {.only = {}, .without = {"provenance/"}});
    return file.ok() ? file.value().blob.ContentHash() : Hash{};
  }

  wire::PrivateFolder folder_;
  EmbeddedOptions options_;
  proto::Job job_;
  BlobPtr log_;
  std::string lines_;
  std::atomic<bool> stop_{false};
  std::function<void(const EmbeddedProgress&)> on_progress_ = [](const EmbeddedProgress&) {};
};

TEST_F(Embedded, GivesTheBitsOfTheInProcessRunAndThenSaysThatItIsDone) {
  const EmbeddedResult result = Run();
  ASSERT_EQ(result.end, EmbeddedEnd::kDone) << result.reason << lines_;
  EXPECT_EQ(result.info.state(), "done");
  EXPECT_EQ(result.results.at("toy"), (fs::path(options_.dir) / "toy.h5").string());
  EXPECT_EQ(Have(), Want());
  EXPECT_EQ(Run().end, EmbeddedEnd::kAlreadyDone);
}

// A run beside it would have its pictures replaced by those of this one.
TEST_F(Embedded, ItsFolderIsItsOwnWhileThePagesAreWritten) {
  int called = 0;
  options_.when_done = [&](const EmbeddedResult& done) {
    ++called;
    EXPECT_TRUE(fs::exists(done.results.at("toy")));
    EmbeddedOptions other = options_;
    other.force = true;
    other.when_done = {};
    EXPECT_EQ(RunEmbedded(other, job_, {{"log", log_}}, {}, stop_).end, EmbeddedEnd::kBusy);
  };
  EXPECT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_EQ(called, 1);
  EXPECT_EQ(Run().end, EmbeddedEnd::kAlreadyDone);
  EXPECT_EQ(called, 2);
  SetOption("rounds", 3);
  EXPECT_EQ(Run().end, EmbeddedEnd::kConflict);
  EXPECT_EQ(called, 2) << "nothing is written beside a result of another run";
}

TEST_F(Embedded, EveryWorkerAlsoOneThatIsStartedAgainReadsTheInputsFromSharedMemory) {
  SetOption("rounds", 200);
  bool killed = false;
  on_progress_ = [&](const EmbeddedProgress& progress) {
    if (killed || progress.info.round() < 3) return;
    killed = ::kill(Children().front(), SIGKILL) == 0;
  };
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone) << lines_;
  EXPECT_TRUE(killed);
  EXPECT_EQ(Have(), Want());
  std::ifstream log(fs::path(options_.dir) / ".cairn" / "workers.log");
  int readers = 0;
  for (std::string line; std::getline(log, line);)
    readers += line.find("reads 1 inputs from memory") != std::string::npos ? 1 : 0;
  EXPECT_EQ(readers, 3);
}

TEST_F(Embedded, AnotherJobInTheSameFolderIsAConflictUntilForced) {
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  SetOption("rounds", 3);
  const Hash before = Have();
  EXPECT_EQ(Run().end, EmbeddedEnd::kConflict);
  EXPECT_EQ(Have(), before);
  options_.force = true;
  EXPECT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_EQ(Have(), Want());
  EXPECT_NE(Have(), before);
  job_.mutable_stages(0)->set_name("other");
  EXPECT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_EQ(Have(), Hash{}) << "the results of the run that was forgotten are gone too";
}

TEST_F(Embedded, ForceKeepsTheOldResultsUntilThereIsANewOne) {
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  const fs::path picture = fs::path(options_.dir) / "map.png";
  std::ofstream(picture) << "of the old run";
  const Hash before = Have();
  const BlobPtr good = log_;
  log_ = std::make_shared<const Blob>(testing::ToyLog(0).Without("truth/"));
  job_.mutable_stages(0)->set_name("other");
  options_.force = true;
  EXPECT_EQ(Run().end, EmbeddedEnd::kInputError);
  EXPECT_EQ(Have(), before) << "a run that was refused takes nothing away";
  EXPECT_TRUE(fs::exists(picture));
  log_ = good;
  EXPECT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_EQ(Have(), Hash{});
  EXPECT_FALSE(fs::exists(picture));
  EXPECT_TRUE(fs::exists(fs::path(options_.dir) / "other.h5"));
}

// Else whoever kills it in between has the old results beside the new ones for ever.
TEST_F(Embedded, WhatItReplacesIsWrittenDownBeforeTheOldRunIsForgotten) {
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  const fs::path replaced = fs::path(options_.dir) / ".cairn" / "replaced";
  fs::create_directories(replaced / "in the way");
  options_.force = true;
  EXPECT_EQ(Run().end, EmbeddedEnd::kFailed);
  fs::remove_all(replaced);
  options_.force = false;
  EXPECT_EQ(Run().end, EmbeddedEnd::kAlreadyDone) << "nothing is forgotten";
}

TEST_F(Embedded, WhatItReplacesGoesAlsoWhereItWasKilledBetweenItsEndAndThat) {
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  const fs::path old = fs::path(options_.dir) / "old.h5";
  std::ofstream(old) << "of the old run";
  std::ofstream(fs::path(options_.dir) / ".cairn" / "replaced") << "old\ntoy\n";
  EXPECT_EQ(Run().end, EmbeddedEnd::kAlreadyDone);
  EXPECT_FALSE(fs::exists(old));
  EXPECT_EQ(Have(), Want());
}

// Who hands on a result folder must not choose what goes from the next person's disk.
TEST_F(Embedded, WhatItReplacesLiesInItsOwnFolder) {
  const fs::path victim = folder_.path() / "victim";
  fs::create_directories(victim);
  fs::create_directories(fs::path(options_.dir) / ".cairn");
  for (const char* name : {"thesis.h5", "report.html"}) std::ofstream(victim / name) << "mine";
  std::ofstream(fs::path(options_.dir) / ".cairn" / "version") << "3\n";
  std::ofstream(fs::path(options_.dir) / ".cairn" / "replaced") << "../victim\n../victim/thesis\n"
                                                                << victim.string() << "\n";
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_TRUE(fs::exists(victim / "thesis.h5"));
  EXPECT_TRUE(fs::exists(victim / "report.html"));
}

// What it replaces is read to 64 kB, which cut "ab" off a name; a file without end is nobody's record.
TEST_F(Embedded, OfWhatItReplacesItReadsNoMoreThanAJobCanHave) {
  constexpr std::size_t kMostBytes = 1 << 16;
  fs::create_directories(fs::path(options_.dir) / ".cairn");
  for (const char* name : {"ab.h5", "absent.h5", "thesis.h5", "old.h5"})
    std::ofstream(fs::path(options_.dir) / name) << "mine";
  std::ofstream(fs::path(options_.dir) / ".cairn" / "version") << "3\n";
  std::string lines = "old\n";
  while (lines.size() < kMostBytes - 2) lines += "\n";
  const fs::path replaced = fs::path(options_.dir) / ".cairn" / "replaced";
  std::ofstream(replaced) << lines << "absent\nthesis\n";
  fs::resize_file(replaced, std::uintmax_t{1} << 33);
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_FALSE(fs::exists(fs::path(options_.dir) / "old.h5"));
  for (const char* name : {"ab.h5", "absent.h5", "thesis.h5"})
    EXPECT_TRUE(fs::exists(fs::path(options_.dir) / name)) << name;
}

TEST_F(Embedded, ALinkInPlaceOfItsFolderIsRefused) {
  const fs::path victim = folder_.path() / "victim";
  fs::create_directories(victim / "sub");
  fs::create_directories(options_.dir);
  std::ofstream(victim / "thesis.txt") << "mine";
  fs::create_directory_symlink(victim, fs::path(options_.dir) / ".cairn");
  options_.force = true;
  EXPECT_EQ(Run().end, EmbeddedEnd::kConflict);
  EXPECT_TRUE(fs::exists(victim / "thesis.txt"));
  EXPECT_TRUE(fs::exists(victim / "sub"));
  fs::remove(fs::path(options_.dir) / ".cairn");
  fs::rename(victim, fs::path(options_.dir) / ".cairn");
  EXPECT_EQ(Run().end, EmbeddedEnd::kInputError) << "a folder of that name with something else in it";
  EXPECT_TRUE(fs::exists(fs::path(options_.dir) / ".cairn" / "thesis.txt"));
}

// Of all below a folder: path -> bytes; folders have none.
std::map<std::string, std::string> AllBelow(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    all[entry.path()] = entry.is_directory() ? "" : std::string(std::istreambuf_iterator<char>(in), {});
  }
  return all;
}

// Each of what a store has could, as a link, lead a run to the next person's files.
TEST_F(Embedded, NoLinkInsideOfItsFolderIsFollowed) {
  const fs::path victim = folder_.path() / "victim", store = fs::path(options_.dir) / ".cairn";
  fs::create_directories(victim);
  for (const char* name : {"1.part", "1.h5", "pack-1.h5", "86c939568204c39f723a34a4e9b96aef.h5", "map.png",
                           "report.html", "version", "1"})
    std::ofstream(victim / name) << (std::string_view(name) == "version" ? "3\n" : "mine");
  std::ofstream(victim / "my.sqlite") << "";
  const auto before = AllBelow(victim);
  const std::pair<const char*, fs::path> links[] = {{".cairn/uploads", victim},
                                                    {".cairn/blobs", victim},
                                                    {".cairn/checkpoints", victim},
                                                    {".cairn/checkpoints/run", victim},
                                                    {".cairn/checkpoints/run/1.h5", victim / "1.h5"},
                                                    {".cairn/jobs.sqlite", victim / "my.sqlite"},
                                                    {".cairn/jobs.sqlite-wal", victim / "made"},
                                                    {".cairn/lock", victim / "made"},
                                                    {".cairn/served", victim / "1"},
                                                    {".cairn/version", victim / "version"},
                                                    {".cairn/workers.log", victim / "1"},
                                                    {".cairn/blobs/deep/er", victim},
                                                    {"toy", victim}};
  for (const bool force : {false, true}) {
    for (const auto& [name, target] : links) {
      fs::remove_all(options_.dir);
      fs::create_directories((fs::path(options_.dir) / name).parent_path());
      fs::create_directories(store);
      if (std::string_view(name) != ".cairn/version") std::ofstream(store / "version") << "3\n";
      fs::create_symlink(target, fs::path(options_.dir) / name);
      options_.force = force;
      const EmbeddedResult result = Run();
      EXPECT_EQ(result.end, EmbeddedEnd::kInputError) << name;
      EXPECT_NE(result.reason.find("is a link"), std::string::npos) << name << ": " << result.reason;
      EXPECT_EQ(AllBelow(victim), before) << name;
    }
  }
}

// What is under way is not led away either: in the middle of it another folder stands behind a link of that
// name.
TEST_F(Embedded, ALinkThatComesInPlaceOfItsFolderInTheMiddleEndsTheRun) {
  SetOption("rounds", 200);
  const fs::path store = fs::path(options_.dir) / ".cairn", elsewhere = folder_.path() / "elsewhere";
  on_progress_ = [&](const EmbeddedProgress& progress) {
    if (progress.info.round() < 3 || fs::exists(fs::symlink_status(elsewhere))) return;
    // Both change places at once: between two renames there would be nothing of that name.
    fs::create_directory_symlink(elsewhere, elsewhere);
    ASSERT_EQ(::renameat2(AT_FDCWD, store.c_str(), AT_FDCWD, elsewhere.c_str(), RENAME_EXCHANGE), 0);
  };
  const EmbeddedResult result = Run();
  EXPECT_EQ(result.end, EmbeddedEnd::kPaused);
  EXPECT_NE(result.reason.find(".cairn was replaced by a link"), std::string::npos) << result.reason;
  EXPECT_EQ(Have(), Hash{});
}

// The stages of a run that is replaced come from its own record.
TEST_F(Embedded, WhatItReplacesIsNotSoughtBehindALink) {
  const fs::path victim = folder_.path() / "victim";
  fs::create_directories(victim);
  fs::create_directories(fs::path(options_.dir) / ".cairn");
  for (const char* name : {"map.png", "report.html"}) std::ofstream(victim / name) << "mine";
  std::ofstream(fs::path(options_.dir) / ".cairn" / "version") << "3\n";
  std::ofstream(fs::path(options_.dir) / ".cairn" / "replaced") << "foo\n";
  fs::create_directory_symlink(victim, fs::path(options_.dir) / "foo");
  const auto before = AllBelow(victim);
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_EQ(AllBelow(victim), before);
}

TEST_F(Embedded, AResultFileOfSomebodyElseIsNotOverwritten) {
  fs::create_directories(options_.dir);
  std::ofstream(fs::path(options_.dir) / "toy.h5") << "mine";
  EXPECT_EQ(Run().end, EmbeddedEnd::kConflict);
  EXPECT_EQ(fs::file_size(fs::path(options_.dir) / "toy.h5"), 4u);
}

TEST_F(Embedded, ADoneRunWhoseResultIsGoneIsNotCalledDone) {
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  fs::remove(fs::path(options_.dir) / "toy.h5");
  EXPECT_EQ(Run().end, EmbeddedEnd::kConflict);
}

// Under its name, whole, and with Cairn's checksum trailer.
TEST_F(Embedded, AnotherFileIsNotTakenForTheResult) {
  ASSERT_EQ(Run().end, EmbeddedEnd::kDone);
  const fs::path file = fs::path(options_.dir) / "toy.h5";
  const Blob own = ReadBlobFile(file).value().blob;
  Blob other = own;
  other.PutScalar<double>("another", 1);
  ASSERT_TRUE(WriteBlobFile(file, "local_map", other).ok());
  const EmbeddedResult result = Run();
  EXPECT_EQ(result.end, EmbeddedEnd::kConflict);
  EXPECT_NE(result.reason.find("toy.h5 is not what it computed"), std::string::npos) << result.reason;
  std::ofstream(file) << "no Cairn file";
  EXPECT_EQ(Run().end, EmbeddedEnd::kConflict);
  ASSERT_TRUE(WriteBlobFile(file, "toy", own).ok());
  EXPECT_EQ(Run().end, EmbeddedEnd::kAlreadyDone);
  ASSERT_TRUE(WriteBlobFile(file, "local_map", other).ok());
  options_.force = true;
  EXPECT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_EQ(Have(), Want());
}

TEST_F(Embedded, StoppedItResumesToTheSameBits) {
  SetOption("rounds", 200);
  on_progress_ = [this](const EmbeddedProgress& progress) { stop_ = progress.info.round() >= 3; };
  const EmbeddedResult stopped = Run();
  ASSERT_EQ(stopped.end, EmbeddedEnd::kStopped) << stopped.reason;
  EXPECT_LT(stopped.info.round(), 200u);
  EXPECT_EQ(Have(), Hash{}) << "nothing is published before its stage ends";
  stop_ = false;
  std::optional<std::uint64_t> first_round;  // the last report is of no round: the stage has ended
  on_progress_ = [&](const EmbeddedProgress& progress) {
    if (!first_round) first_round = progress.info.round();
  };
  const EmbeddedResult result = Run();
  ASSERT_EQ(result.end, EmbeddedEnd::kDone) << result.reason;
  EXPECT_TRUE(result.resumed);
  ASSERT_TRUE(first_round);
  EXPECT_GE(*first_round, stopped.info.round());
  EXPECT_EQ(Have(), Want());
}

// The user's own files hold them, and the next start brings them along.
TEST_F(Embedded, InputsAreNotCopiedAndARunThatWaitsForItsOwnIsNotTakenForAnothers) {
  SetOption("rounds", 200);
  on_progress_ = [this](const EmbeddedProgress& progress) { stop_ = progress.info.round() >= 3; };
  ASSERT_EQ(Run().end, EmbeddedEnd::kStopped);
  stop_ = false;
  std::size_t files = 0;
  for (const auto& file : fs::recursive_directory_iterator(fs::path(options_.dir) / ".cairn")) {
    ++files;
    EXPECT_EQ(file.path().string().find(log_->ContentHash().Hex()), std::string::npos) << file.path();
  }
  EXPECT_GT(files, 0u);
  const BlobPtr own = log_;
  log_ = std::make_shared<const Blob>(testing::ToyLog(51).Without("truth/"));
  EXPECT_EQ(Run().end, EmbeddedEnd::kConflict) << "of another log";
  log_ = own;
  on_progress_ = [](const EmbeddedProgress&) {};
  const EmbeddedResult result = Run();
  ASSERT_EQ(result.end, EmbeddedEnd::kDone) << result.reason << lines_;
  EXPECT_TRUE(result.resumed);
  EXPECT_EQ(Have(), Want());
}

TEST_F(Embedded, AWorkerThatDiesIsStartedAgainAndTheBitsAreTheSame) {
  SetOption("rounds", 200);
  bool killed = false;
  on_progress_ = [&](const EmbeddedProgress& progress) {
    if (progress.info.round() < 3 || progress.workers < 2 || std::exchange(killed, true)) return;
    ASSERT_EQ(Children().size(), 2u);
    ::kill(Children()[0], SIGKILL);
  };
  const EmbeddedResult result = Run();
  ASSERT_EQ(result.end, EmbeddedEnd::kDone) << result.reason;
  EXPECT_TRUE(killed);
  EXPECT_NE(lines_.find("died of signal 9"), std::string::npos) << lines_;
  EXPECT_EQ(Have(), Want());
  EXPECT_TRUE(Children().empty());
}

TEST_F(Embedded, AWorkerThatStandsStillIsReplaced) {
  SetOption("rounds", 200);
  options_.workers = 1;
  bool stopped = false;
  on_progress_ = [&](const EmbeddedProgress& progress) {
    if (progress.info.round() < 3 || std::exchange(stopped, true)) return;
    ASSERT_EQ(Children().size(), 1u);
    ::kill(Children()[0], SIGSTOP);
  };
  const EmbeddedResult result = Run();
  ASSERT_EQ(result.end, EmbeddedEnd::kDone) << result.reason;
  EXPECT_TRUE(stopped);
  EXPECT_NE(lines_.find("was silent for too long (stopped?) and is replaced"), std::string::npos) << lines_;
  EXPECT_EQ(lines_.find("memory ran out"), std::string::npos) << lines_;
  EXPECT_EQ(Have(), Want());
  EXPECT_TRUE(Children().empty());
}

TEST_F(Embedded, AFolderIsForOneRunAtATime) {
  EmbeddedEnd second = EmbeddedEnd::kDone;
  bool tried = false;
  on_progress_ = [&](const EmbeddedProgress&) {
    if (!std::exchange(tried, true)) second = Run().end;
  };
  EXPECT_EQ(Run().end, EmbeddedEnd::kDone);
  EXPECT_EQ(second, EmbeddedEnd::kBusy);
}

TEST_F(Embedded, BadInputEndsTheRunWithTheReason) {
  log_ = std::make_shared<const Blob>(testing::ToyLog(0).Without("truth/"));
  const EmbeddedResult result = Run();
  EXPECT_EQ(result.end, EmbeddedEnd::kInputError);
  EXPECT_NE(result.reason.find("the log has no odometry"), std::string::npos) << result.reason;
  EXPECT_EQ(Run().end, EmbeddedEnd::kInputError) << "and so each time";
  log_ = std::make_shared<const Blob>(testing::ToyLog(50).Without("truth/"));
  EXPECT_EQ(Run().end, EmbeddedEnd::kDone) << "a mended log needs no force";
  EXPECT_EQ(Have(), Want());
}

TEST_F(Embedded, WorkersThatCannotWorkEndTheRun) {
  options_.worker_program = "/bin/false";
  EmbeddedResult result = Run();
  EXPECT_EQ(result.end, EmbeddedEnd::kFailed);
  EXPECT_NE(result.reason.find("workers.log"), std::string::npos);
  options_.worker_program = "/nowhere/cairn-worker";
  result = Run();
  EXPECT_EQ(result.end, EmbeddedEnd::kFailed);
  EXPECT_NE(result.reason.find("/nowhere/cairn-worker"), std::string::npos);
}

}  // namespace
}  // namespace cairn::faults
