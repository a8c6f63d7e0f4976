#include "coordinator/store/sqlite_files.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>

#include "coordinator/server/testing/hub_fixture.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

std::string BigEndian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

// As https://sqlite.org/fileformat.html has it: no page, and the name of a super-journal.
std::string JournalThatNames(const std::string& file, std::uint32_t pages) {
  const std::string magic = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";
  std::string journal = magic;
  for (const std::uint32_t number : {0U, 1U, pages, 512U, 4096U}) journal += BigEndian(number);
  journal.resize(512);
  std::uint32_t sum = 0;
  for (const char c : file) sum += static_cast<unsigned char>(c);
  constexpr std::uint32_t kLockingPage = 0x40000000 / 4096 + 1;
  return journal + BigEndian(kLockingPage) + file + BigEndian(static_cast<std::uint32_t>(file.size())) +
         BigEndian(sum) + magic;
}

class JobTableFiles : public testing::Test {
 protected:
  JobTableFiles() {
    EXPECT_TRUE(JobTable::Open(table()).value().NoteRemoval("7-a").ok());
    std::ofstream(victim()) << "mine";
  }
  fs::path table() const { return folder_.value().JobTable(); }
  fs::path victim() const { return temp_.path() / "thesis.txt"; }
  void Execute(const char* sql) const {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(table().c_str(), &db), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(db, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
    sqlite3_close(db);
  }
  void WriteJournal() const {
    const auto pages = static_cast<std::uint32_t>(fs::file_size(table()) / 4096);
    std::ofstream(table().string() + "-journal", std::ios::binary)
        << JournalThatNames(victim().string(), pages);
  }
  // The highest number that the table, opened as at a start, knows.
  std::uint64_t LastNumber() {
    warnings_.clear();
    const Result<JobTable> opened = OpenJobTable(
        folder_.value(), [this](Severity, const std::string& line) { warnings_ += line + "\n"; });
    EXPECT_TRUE(opened.ok()) << opened.status().message();
    return opened.ok() ? opened.value().LastNumber() : 0;
  }

  TempFolder temp_;
  Result<StoreFolder> folder_ = StoreFolder::Open(temp_.path() / "s");
  std::string warnings_;
};

// SQLite checks the tree of pages, and takes what the rows say as it is.
TEST_F(JobTableFiles, LinesThatNobodyWroteAreRemovedAtAStartWhichSaysSo) {
  Execute("INSERT INTO log VALUES ('7-a', 1, '2026-11-21T14:20:05Z', 'info', 'a whole line');");
  for (const char* damaged :
       {"'7-a', 2, '2026-11-21T14:20:05Z', 'info', CAST(x'61ff62' AS TEXT)",
        "'7-a', 3, '2026-11-21T14:20:05Z', x'696e666f', 'text'", "'7-a', -4, 'now', 'info', 'text'",
        "'7-a', 5, '', 'info', 'text'", "'7-a', 'six', 'now', 'info', 'text'",
        "CAST(x'372dff' AS TEXT), 7, 'now', 'info', 'text'"}) {
    Execute((std::string("INSERT INTO log VALUES (") + damaged + ");").c_str());
    EXPECT_EQ(JobTable::Open(table()).value().damaged_lines().count, 1U) << damaged;
    EXPECT_EQ(LastNumber(), 7U);
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "removed damaged lines from the logs of jobs: 1, of job '7-",
                        warnings_);
    EXPECT_EQ(JobTable::Open(table()).value().damaged_lines().count, 0U) << damaged;
  }
  EXPECT_EQ(LastNumber(), 7U);
  EXPECT_EQ(warnings_, "");
  EXPECT_EQ(JobTable::Open(table()).value().ReadLog("7-a", 0).value().size(), 1U);
}

// In either mode: where the file system has no shared memory, SQLite leaves it in this one.
TEST_F(JobTableFiles, AJournalThatNamesAFileRemovesNothing) {
  for (const char* mode : {"PRAGMA journal_mode = WAL;", "PRAGMA journal_mode = DELETE;"}) {
    Execute(mode);
    WriteJournal();
    EXPECT_EQ(LastNumber(), 7u);
    EXPECT_TRUE(fs::exists(victim())) << mode;
    EXPECT_TRUE(fs::exists(table().string() + "-journal.damaged")) << mode;
    EXPECT_NE(warnings_.find("jobs.sqlite-journal"), std::string::npos) << warnings_;
    fs::remove(table().string() + "-journal.damaged");
  }
}

TEST_F(JobTableFiles, TheJournalAboveIsOneThatSqliteWouldFollow) {
  WriteJournal();
  Execute("SELECT count(*) FROM last_number;");
  EXPECT_FALSE(fs::exists(victim()));
}

// A process that died amidst a write, where the file is not in WAL mode.
TEST_F(JobTableFiles, AJournalOfItsOwnIsPlayedBack) {
  Execute("PRAGMA journal_mode = DELETE;");
  fs::copy_file(table(), temp_.path() / "good");
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(table().c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "BEGIN; UPDATE last_number SET number = 100;", nullptr, nullptr, nullptr),
            SQLITE_OK);
  ASSERT_EQ(sqlite3_db_cacheflush(db), SQLITE_OK);
  fs::copy_file(table(), temp_.path() / "half");
  fs::copy_file(table().string() + "-journal", temp_.path() / "journal");
  sqlite3_close(db);
  fs::copy_file(temp_.path() / "half", table(), fs::copy_options::overwrite_existing);
  fs::copy_file(temp_.path() / "journal", table().string() + "-journal");
  EXPECT_EQ(LastNumber(), 7u);
}

TEST_F(JobTableFiles, WhatIsNoFileIsNotWaitedFor) {
  for (const char* ending : {"-journal", "-wal", "-shm"}) {
    for (const char* beside : {"-wal", "-shm"}) fs::remove(table().string() + beside);
    const fs::path fifo = table().string() + ending;
    ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
    EXPECT_EQ(LastNumber(), 7u) << ending;
    EXPECT_TRUE(fs::is_fifo(fifo.string() + ".damaged")) << ending;
    fs::remove(fifo.string() + ".damaged");
  }
  fs::rename(table(), temp_.path() / "elsewhere");
  fs::create_symlink(temp_.path() / "elsewhere", table());
  EXPECT_EQ(LastNumber(), 0u) << "anew";
}

// Whoever hands on a store must not choose what is computed when it is served.
TEST_F(JobTableFiles, ATableThatHoldsMoreThanOursIsBegunAnew) {
  for (const char* more :
       {"CREATE TRIGGER t AFTER UPDATE ON last_number BEGIN DELETE FROM log; END;",
        "CREATE VIEW v AS SELECT number FROM last_number;", "CREATE TABLE other (id TEXT);",
        "CREATE INDEX i ON log (text);",
        "ALTER TABLE last_number RENAME TO l; CREATE VIEW last_number AS SELECT 1 AS one, 9 AS number;",
        "DROP TABLE log; CREATE TABLE log (job TEXT, number INTEGER, utc TEXT, level TEXT,"
        "                                  text TEXT CHECK (length(randomblob(1000000000)) > 0));"}) {
    fs::remove(table().string() + ".damaged");
    EXPECT_TRUE(JobTable::Open(table()).value().NoteRemoval("7-a").ok());
    Execute(more);
    EXPECT_EQ(LastNumber(), 0u) << more;
    EXPECT_NE(warnings_.find("made the job table anew"), std::string::npos) << more << warnings_;
    EXPECT_TRUE(fs::exists(table().string() + ".damaged")) << more;
  }
}

}  // namespace
}  // namespace cairn::coordinator
