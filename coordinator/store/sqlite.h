// What of SQLite the job table needs, behind RAII types and Results.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <string>

#include "schema/error.h"

namespace cairn::coordinator::sqlite {

struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

// What the file may say is not followed: no triggers, no views, no functions but harmless ones; no text of it
// takes more than a few megabytes.
Status Harden(sqlite3* db);
// Of the last call: kCorrupt, kNoSpace or kIo, with the file's name; `opened` is that of one that could not
// be opened, which SQLite forgets.
Status Failure(sqlite3* db, const std::string& opened = {});

// While it lives, what the connection does ends with kCorrupt after so many steps of SQLite's machine (some
// ten a row): pages that name each other in a circle, or the same page a hundred times, would be read for
// ever. Steps, not seconds: a slow machine reads what a fast one reads.
class StepLimit {
 public:
  StepLimit(sqlite3* db, std::uint64_t most);
  ~StepLimit();
  StepLimit(const StepLimit&) = delete;
  StepLimit& operator=(const StepLimit&) = delete;

 private:
  static int CountDown(void* left);
  sqlite3* db_;
  std::uint64_t left_;  // in portions of kPortion
};

// kCorrupt where its pages are not a database's: one is named twice, or none is where one should be. Takes
// time and steps in proportion to the file. kIo: the disk does not give it all; what is there nobody knows.
Status CheckPages(sqlite3* db);
Result<Statement> Prepare(sqlite3* db, const char* sql);
Status Execute(sqlite3* db, const char* sql);
// The one number that a query gives.
Result<std::int64_t> Number(sqlite3* db, const char* sql);

void Bind(sqlite3_stmt* statement, int place, const std::string& text);
void Bind(sqlite3_stmt* statement, int place, std::uint64_t number);
std::string Text(sqlite3_stmt* statement, int column);
std::uint64_t Unsigned(sqlite3_stmt* statement, int column);  // 0 where it is negative

}  // namespace cairn::coordinator::sqlite
