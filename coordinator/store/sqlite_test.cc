// What a damaged file can cost whoever reads it.
#include "coordinator/store/sqlite.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/job_table.h"
#include "coordinator/store/recovery.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

struct CloseDb {
  void operator()(sqlite3* db) const { sqlite3_close(db); }
};
using Database = std::unique_ptr<sqlite3, CloseDb>;

Database OpenDatabase(const std::string& path) {
  sqlite3* db = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  return Database(db);
}

constexpr const char* kEndless =
    "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT count(*) FROM n;";

TEST(StepLimit, EndsWhatWouldGoOnForEverAndCallsItDamaged) {
  const Database db = OpenDatabase(":memory:");
  const sqlite::StepLimit limit(db.get(), 1'000'000);
  const Status status = sqlite::Number(db.get(), kEndless).status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_NE(status.message().find("damaged: reading it takes more steps"), std::string::npos)
      << status.message();
}

TEST(StepLimit, HoldsForAsLongAsItLives) {
  const Database db = OpenDatabase(":memory:");
  const std::string much =
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 100000) SELECT count(*) FROM n;";
  {
    const sqlite::StepLimit limit(db.get(), 100'000);
    EXPECT_FALSE(sqlite::Number(db.get(), much.c_str()).ok());
  }
  EXPECT_EQ(sqlite::Number(db.get(), much.c_str()).value(), 100'000);
}

TEST(Harden, ATextOfMegabytesIsDamage) {
  const Database db = OpenDatabase(":memory:");
  ASSERT_TRUE(sqlite::Harden(db.get()).ok());
  const Status status = sqlite::Number(db.get(), "SELECT length(zeroblob(17000000));").status();
  EXPECT_EQ(status.code(), Code::kCorrupt) << status.message();
}

std::uint32_t BigEndianAt(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < count; ++i) number = number << 8 | static_cast<unsigned char>(bytes[at + i]);
  return number;
}

void PutBigEndian(std::string* bytes, std::size_t at, std::uint32_t number) {
  for (std::size_t i = 0; i < 4; ++i) (*bytes)[at + i] = static_cast<char>(number >> (24 - 8 * i) & 0xff);
}

// https://sqlite.org/fileformat.html: an inner page of an index has the page below each of its cells in the
// cell's first four bytes, and that of the last at 8.
constexpr std::size_t kPageBytes = 4096;

void PointAllTo(std::uint32_t below, std::size_t page, std::string* file) {
  const std::size_t at = (page - 1) * kPageBytes;
  const std::uint32_t cells = BigEndianAt(*file, at + 3, 2);
  for (std::uint32_t i = 0; i < cells; ++i)
    PutBigEndian(file, at + BigEndianAt(*file, at + 12 + 2 * i, 2), below);
  PutBigEndian(file, at + 8, below);
}

// An inner page of a table, whose header stands at `header`: each of its cells leads to the same page.
void PutInnerPage(std::uint32_t below, std::size_t page, std::size_t header, std::string* file) {
  constexpr std::size_t kCells = 100, kCellBytes = 5, kInnerOfTable = 5;
  const std::size_t at = (page - 1) * kPageBytes;
  const std::size_t content = kPageBytes - kCells * kCellBytes;
  std::fill_n(file->begin() + static_cast<std::ptrdiff_t>(at + header), kPageBytes - header, '\0');
  PutBigEndian(file, at + header, kInnerOfTable << 24);
  PutBigEndian(file, at + header + 3, kCells << 16 | content);
  PutBigEndian(file, at + header + 8, below);
  for (std::size_t i = 0; i < kCells; ++i) {
    const std::size_t cell = content + i * kCellBytes;
    PutBigEndian(file, at + cell, below);
    (*file)[at + cell + 4] = static_cast<char>(i + 1);
    (*file)[at + header + 12 + 2 * i] = static_cast<char>(cell >> 8);
    (*file)[at + header + 13 + 2 * i] = static_cast<char>(cell & 0xff);
  }
}

// A disk that does not give what is read once.
int reads_before_it_fails = 0;
const sqlite3_io_methods* of_the_disk = nullptr;
int ReadOrFail(sqlite3_file* file, void* bytes, int count, sqlite3_int64 at) {
  return reads_before_it_fails-- == 0 ? SQLITE_IOERR_READ : of_the_disk->xRead(file, bytes, count, at);
}

TEST(CheckPages, ADiskThatFailsForAMomentIsNoDamage) {
  const TempFolder temp;
  const std::string path = (temp.path() / "table").string();
  const char* fill =
      "CREATE TABLE t (x); WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 2000) "
      "INSERT INTO t SELECT hex(randomblob(50)) FROM n;";
  ASSERT_TRUE(sqlite::Execute(OpenDatabase(path).get(), fill).ok());
  int whole = 0;
  for (int reads = 0; reads < 20; ++reads) {
    const Database db = OpenDatabase(path);
    ASSERT_TRUE(sqlite::Number(db.get(), "SELECT count(*) FROM sqlite_master;").ok());
    sqlite3_file* file = nullptr;
    ASSERT_EQ(sqlite3_file_control(db.get(), "main", SQLITE_FCNTL_FILE_POINTER, &file), SQLITE_OK);
    of_the_disk = file->pMethods;
    sqlite3_io_methods failing = *of_the_disk;
    failing.xRead = ReadOrFail;
    file->pMethods = &failing;
    reads_before_it_fails = reads;
    const Status status = sqlite::CheckPages(db.get());
    file->pMethods = of_the_disk;
    ASSERT_LT(reads_before_it_fails, 0) << "it did fail";
    EXPECT_NE(status.code(), Code::kCorrupt) << reads << ": " << status.message();
    whole += status.ok() ? 1 : 0;
  }
  EXPECT_GT(whole, 10) << "SQLite itself says so of few";
}

// A store's table with the log of one job, which fills some pages.
class DamagedTable : public ::testing::Test {
 protected:
  DamagedTable() {
    JobTable table = JobTable::Open(path()).value();
    EXPECT_TRUE(table.NoteRemoval("7-a").ok());
    JobLines lines;
    for (int i = 0; i < 1500; ++i) lines.lines.emplace_back().set_text(std::string(100, 'x'));
    EXPECT_TRUE(table.AppendLog({{"1-a", lines}}).ok());
  }
  fs::path path() const { return folder_.value().JobTable(); }
  std::string Read() const {
    std::ifstream in(path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void Write(const std::string& bytes) const { std::ofstream(path(), std::ios::binary) << bytes; }
  std::size_t RootOfLog() const {
    const Database db = OpenDatabase(path().string());
    return static_cast<std::size_t>(
        sqlite::Number(db.get(), "SELECT rootpage FROM sqlite_master WHERE name = 'log';").value());
  }

  // The root's pages are all one, whose pages are all the next, and so on: as many rows to read as there are
  // ways down, though the file is small.
  void LeadDownManyWays() const {
    constexpr std::uint32_t kLevels = 15;  // SQLite goes down no more than 20
    const std::size_t root = RootOfLog();
    std::string file = Read();
    ASSERT_EQ(file[(root - 1) * kPageBytes], 2) << "an inner page of an index";
    const std::string page = file.substr((root - 1) * kPageBytes, kPageBytes);
    const std::uint32_t leaf = BigEndianAt(page, 8, 4);
    const auto first = static_cast<std::uint32_t>(file.size() / kPageBytes + 1);
    PointAllTo(first, root, &file);
    for (std::uint32_t level = 0; level < kLevels; ++level) {
      file += page;
      PointAllTo(level + 1 < kLevels ? first + level + 1 : leaf, first + level, &file);
    }
    PutBigEndian(&file, 28, static_cast<std::uint32_t>(file.size() / kPageBytes));
    Write(file);
  }

  // The same of the list of tables, which SQLite reads before it is asked for anything of the file.
  void LeadDownManyWaysToTheTables() const {
    constexpr std::uint32_t kLevels = 12;
    constexpr std::size_t kHeader = 100;  // of the file, on the first page
    std::string file = Read();
    std::string leaf = file.substr(0, kPageBytes);
    const std::size_t pointers = 2 * BigEndianAt(leaf, kHeader + 3, 2);
    leaf.replace(0, 8 + pointers, leaf.substr(kHeader, 8 + pointers));
    const auto first = static_cast<std::uint32_t>(file.size() / kPageBytes + 1);
    file.resize(file.size() + kLevels * kPageBytes);
    PutInnerPage(first, 1, kHeader, &file);
    for (std::uint32_t level = 0; level < kLevels; ++level)
      PutInnerPage(first + level + 1, first + level, 0, &file);
    file += leaf;
    PutBigEndian(&file, 28, static_cast<std::uint32_t>(file.size() / kPageBytes));
    Write(file);
  }

  TempFolder temp_;
  Result<StoreFolder> folder_ = StoreFolder::Open(temp_.path() / "s");
};

TEST_F(DamagedTable, PagesThatAreNamedTwiceAreFoundWhenItIsOpened) {
  LeadDownManyWays();
  const Status status = JobTable::Open(path()).status();
  ASSERT_EQ(status.code(), Code::kCorrupt) << status.message();
  EXPECT_NE(status.message().find("jobs.sqlite: damaged: "), std::string::npos) << status.message();
}

TEST_F(DamagedTable, AListOfTablesWithoutEndIsNotReadToItsEnd) {
  LeadDownManyWaysToTheTables();
  const Status status = JobTable::Open(path()).status();
  ASSERT_EQ(status.code(), Code::kCorrupt) << status.message();
  EXPECT_NE(status.message().find("damaged: reading it takes more steps"), std::string::npos)
      << status.message();
  EXPECT_EQ(JobTable::LastNumberIn(path()), 0u);
}

// A deleted job's number must not come back because the log was damaged.
TEST_F(DamagedTable, IsMadeAnewWithTheNumberThatItKnew) {
  LeadDownManyWays();
  std::string warnings;
  const Result<JobTable> table =
      OpenJobTable(folder_.value(), [&](Severity, const std::string& line) { warnings += line + "\n"; });
  ASSERT_TRUE(table.ok()) << table.status().message();
  EXPECT_EQ(table.value().LastNumber(), 7u);
  EXPECT_TRUE(table.value().ReadLog("1-a", 0).value().empty());
  EXPECT_NE(warnings.find("made the job table anew, without the logs of jobs"), std::string::npos);
  EXPECT_TRUE(fs::exists(path().string() + ".damaged"));
  EXPECT_EQ(JobTable::Open(path()).value().LastNumber(), 7u) << "durable";
}

TEST_F(DamagedTable, OneWithoutDamageIsNone) {
  const Result<JobTable> table = JobTable::Open(path());
  ASSERT_TRUE(table.ok()) << table.status().message();
  EXPECT_EQ(table.value().ReadLog("1-a", 0).value().size(), 1500u);
}

TEST_F(DamagedTable, OfMoreLinesThanAreEverKeptNoMoreAreRead) {
  {
    const Database db = OpenDatabase(path().string());
    ASSERT_TRUE(
        sqlite::Execute(db.get(),
                        "WITH RECURSIVE n(i) AS (SELECT 10000 UNION ALL SELECT i + 1 FROM n LIMIT 9000) "
                        "INSERT INTO log SELECT '1-a', i, '', '', '' FROM n;")
            .ok());
  }
  EXPECT_EQ(JobTable::Open(path()).value().ReadLog("1-a", 0).value().size(), kLinesKept);
}

// Of what was good when it was opened.
TEST_F(DamagedTable, PagesThatAreNamedTwiceLaterAreNotReadForEver) {
  Result<JobTable> table = JobTable::Open(path());
  ASSERT_TRUE(table.ok());
  LeadDownManyWays();
  // After another's commit nothing that is known of the file counts.
  ASSERT_TRUE(
      sqlite::Execute(OpenDatabase(path().string()).get(), "UPDATE last_number SET number = 8;").ok());
  EXPECT_EQ(table.value().ReadLog("1-a", 0).value().size(), kLinesKept);
  const Status status = table.value().Remove("1-a");
  EXPECT_EQ(status.code(), Code::kCorrupt) << status.message();
}

// While it is in use: what was good when it was opened.
TEST_F(DamagedTable, WhatShowsLaterSaysWhatToDo) {
  const Result<JobTable> table = JobTable::Open(path());
  ASSERT_TRUE(table.ok());
  const Database db = OpenDatabase(path().string());
  ASSERT_TRUE(sqlite::Execute(db.get(), "ALTER TABLE log RENAME TO lost;").ok());
  const Status status = table.value().ReadLog("1-a", 0).status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_NE(status.message().find("damaged: "), std::string::npos) << status.message();
  EXPECT_NE(status.message().find("start the coordinator again: it makes the table anew"), std::string::npos)
      << status.message();
}

}  // namespace
}  // namespace cairn::coordinator
