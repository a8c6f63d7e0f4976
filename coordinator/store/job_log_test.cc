// Logs of jobs: what waits, the table, and what a service answers.
#include "coordinator/store/job_log.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/job_table.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

wire::LogLine Line(const std::string& text, const std::string& level = "info") {
  wire::LogLine line;
  line.set_utc("2026-11-21T14:20:05Z");
  line.set_level(level);
  line.set_text(text);
  return line;
}

std::map<std::string, JobLines> Lines(const std::string& job, int count, int first = 1) {
  WaitingLines waiting;
  for (int i = first; i < first + count; ++i) waiting.Add(job, Line("line " + std::to_string(i)));
  return waiting.Take();
}

class LogTable : public ::testing::Test {
 protected:
  JobTable Open() { return JobTable::Open(path()).value(); }
  fs::path path() const { return temp_.path() / "jobs.sqlite"; }
  TempFolder temp_;
};

TEST_F(LogTable, ReadsWhatWasWrittenInOrderAfterARestartToo) {
  {
    JobTable table = Open();
    ASSERT_TRUE(
        table
            .AppendLog({{"1-a", {0, {Line("it's \"quoted\"; DROP TABLE log"), Line("two", "warning")}}},
                        {"2-b", {0, {Line("of another")}}}})
            .ok());
  }
  JobTable table = Open();
  ASSERT_TRUE(table.AppendLog({{"1-a", {0, {Line("three")}}}}).ok());
  const auto lines = table.ReadLog("1-a", 0).value();
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].text(), "it's \"quoted\"; DROP TABLE log");
  EXPECT_EQ(lines[0].utc(), "2026-11-21T14:20:05Z");
  EXPECT_EQ(lines[1].level(), "warning");
  EXPECT_EQ(lines[2].number(), 3u);
  EXPECT_EQ(table.ReadLog("1-a", 2).value().size(), 1u);
  EXPECT_EQ(table.ReadLog("2-b", 0).value().size(), 1u);
  EXPECT_TRUE(table.ReadLog("nobody", 0).value().empty());
}

TEST_F(LogTable, KeepsTheNewestLinesAndTheirNumbersSayHowManyWent) {
  JobTable table = Open();
  const int kept = static_cast<int>(kLinesKept);
  ASSERT_TRUE(table.AppendLog(Lines("1-a", kept)).ok());
  EXPECT_EQ(table.ReadLog("1-a", 0).value().front().number(), 1u) << "none has gone yet";
  ASSERT_TRUE(table.AppendLog(Lines("1-a", 12, kept + 1)).ok());
  const auto lines = table.ReadLog("1-a", 0).value();
  ASSERT_EQ(lines.size(), kLinesKept);
  EXPECT_EQ(lines.front().number(), 13u);
  EXPECT_EQ(lines.front().text(), "line 13");
  EXPECT_EQ(lines.back().number(), kLinesKept + 12);
}

TEST_F(LogTable, WhatWasPushedOutBeforeItWasWrittenCounts) {
  JobTable table = Open();
  ASSERT_TRUE(table.AppendLog(Lines("1-a", 5)).ok());
  std::map<std::string, JobLines> waited = Lines("1-a", static_cast<int>(kLinesKept) + 7, 6);
  EXPECT_EQ(waited.at("1-a").gone, 7u);
  EXPECT_EQ(waited.at("1-a").lines.size(), kLinesKept);
  ASSERT_TRUE(table.AppendLog(waited).ok());
  const auto lines = table.ReadLog("1-a", 0).value();
  ASSERT_EQ(lines.size(), kLinesKept);
  EXPECT_EQ(lines.front().text(), "line " + std::to_string(lines.front().number()));
  EXPECT_EQ(lines.front().number(), 13u);
}

TEST_F(LogTable, ARemovedJobsLinesGoAndNoOthers) {
  JobTable table = Open();
  ASSERT_TRUE(table.AppendLog(Lines("1-a", 3)).ok());
  ASSERT_TRUE(table.AppendLog(Lines("2-b", 3)).ok());
  ASSERT_TRUE(table.Remove("1-a").ok());
  EXPECT_TRUE(table.ReadLog("1-a", 0).value().empty());
  EXPECT_EQ(table.ReadLog("2-b", 0).value().size(), 3u);
}

// What a bad disk may make of a file: it is read, or refused as corrupt, and its texts fit into a message.
TEST_F(LogTable, NoFlippedByteNorTruncationGoesFurtherThanAStatus) {
  {
    JobTable table = Open();
    ASSERT_TRUE(table.AppendLog(Lines("1-a", 3)).ok());
  }
  std::ifstream in(path(), std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  ASSERT_GT(good.size(), 4096u);
  int refused = 0;
  const auto look = [&](const std::string& bytes) {
    for (const char* ending : {"", "-wal", "-shm"}) fs::remove(path().string() + ending);
    std::ofstream(path(), std::ios::binary) << bytes;
    Result<JobTable> table = JobTable::Open(path());
    const auto lines = table.ok() ? table.value().ReadLog("1-a", 0) : table.status();
    if (!lines.ok()) return ++refused, void();
    wire::Reply reply;
    for (const wire::LogLine& line : lines.value()) *reply.add_log() = line;
    EXPECT_TRUE(wire::Reply().ParseFromString(reply.SerializeAsString()));
  };
  for (std::size_t at = 0; at < good.size(); at += 97) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x80);
    look(bytes);
  }
  for (std::size_t bytes = 0; bytes < good.size(); bytes += 511) look(good.substr(0, bytes));
  EXPECT_GT(refused, 5);
}

// The file as version 2 wrote it, made by the statements of that version.
TEST_F(LogTable, OneOfVersion2IsUpgradedWithItsNumbers) {
  {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(path().c_str(), &db), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(db, R"sql(
      CREATE TABLE jobs (
        id TEXT PRIMARY KEY, name TEXT NOT NULL, state TEXT NOT NULL, reason TEXT NOT NULL,
        stage INTEGER NOT NULL, stages INTEGER NOT NULL, round INTEGER NOT NULL, note TEXT NOT NULL,
        input_error INTEGER NOT NULL, seconds REAL NOT NULL,
        submitted_utc TEXT NOT NULL, updated_utc TEXT NOT NULL);
      INSERT INTO jobs VALUES ('15-a', 'a', 'done', '', 0, 1, 7, '', 0, 1.5, 'then', 'now');
      CREATE TABLE last_removed (one INTEGER PRIMARY KEY CHECK (one = 1), number INTEGER NOT NULL);
      INSERT INTO last_removed VALUES (1, 12);
      PRAGMA user_version = 2;)sql",
                           nullptr, nullptr, nullptr),
              SQLITE_OK);
    sqlite3_close(db);
  }
  for (int i = 1; i <= 2; ++i) {
    JobTable table = Open();
    EXPECT_EQ(table.LastNumber(), 15u);
    ASSERT_TRUE(table.AppendLog(Lines("1-a", 1)).ok());
    EXPECT_EQ(table.ReadLog("1-a", 0).value().size(), static_cast<std::size_t>(i));
  }
}

wire::Message AskLog(const std::string& job, std::uint64_t after = 0) {
  wire::Message message;
  message.envelope.mutable_query()->set_job(job);
  message.envelope.mutable_query()->set_action("logs");
  message.envelope.mutable_query()->set_after(after);
  return message;
}

TEST(JobLog, AServiceTellsAJobsStoryToItsEnd) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return fixture.State() == "done"; });
  const wire::Reply reply = fixture.Ask(AskLog("a"));
  ASSERT_TRUE(reply.ok()) << reply.message();
  EXPECT_EQ(reply.jobs(0).state(), "done");
  ASSERT_GE(reply.log_size(), 7);
  EXPECT_EQ(reply.log(0).text(), "submitted: 1 stage");
  EXPECT_EQ(reply.log(reply.log_size() - 1).text(), "done");
  for (int i = 0; i < reply.log_size(); ++i)
    EXPECT_EQ(reply.log(i).number(), static_cast<std::uint64_t>(i + 1));
  EXPECT_EQ(fixture.Ask(AskLog("a", 3)).log(0).number(), 4u);
}

TEST(JobLog, OutlivesTheCoordinatorAndSaysThatItWasStartedAgain) {
  ServerFixture fixture;
  fixture.Submit("a");
  EXPECT_EQ(fixture.Ask(AskLog("a")).log_size(), 1);
  fixture.Until([&] { return !fixture.server->core().HasUnsaved(); });
  fixture.Start();  // without a word to the old one
  const wire::Reply reply = fixture.Ask(AskLog("a"));
  ASSERT_EQ(reply.log_size(), 2);
  EXPECT_EQ(reply.log(0).text(), "submitted: 1 stage");
  EXPECT_TRUE(reply.log(1).text().starts_with("the coordinator was started again: goes on"))
      << reply.log(1).text();
}

TEST(JobLog, SaysWhichCheckpointWasQuarantinedAndWhy) {
  ServerFixture fixture;
  fixture.transport.swallow = [](const wire::Assign& assign) { return assign.key().round() == 1; };
  fixture.transport.ComeWorker("w");
  fixture.Submit("a");
  fixture.Until([&] {
    return fixture.folder->CheckpointNumbers("a").size() == 2 && !fixture.server->core().HasUnsaved();
  });
  fixture.server.reset();
  fs::resize_file(fixture.folder->CheckpointFile("a", fixture.folder->CheckpointNumbers("a").back()), 100);
  fixture.Start();
  const wire::Reply reply = fixture.Ask(AskLog("a"));
  bool found = false;
  for (const wire::LogLine& line : reply.log())
    found |= line.level() == "warning" && line.text().starts_with("quarantined the checkpoint ");
  EXPECT_TRUE(found) << reply.DebugString();
}

TEST(JobLog, GoesWithItsJob) {
  ServerFixture fixture;
  fixture.Submit("a");
  for (const char* action : {"cancel", "delete"}) {
    wire::Message message = AskLog("a");
    message.envelope.mutable_query()->set_action(action);
    ASSERT_TRUE(fixture.Ask(message).ok());
  }
  EXPECT_NE(fixture.Ask(AskLog("a")).message().find("there is no job 'a'"), std::string::npos);
  EXPECT_NE(fixture.Ask(AskLog("")).message().find("which job?"), std::string::npos);
  fixture.server.reset();
  EXPECT_TRUE(JobTable::Open(fixture.folder->JobTable()).value().ReadLog("a", 0).value().empty());
}

}  // namespace
}  // namespace cairn::coordinator
