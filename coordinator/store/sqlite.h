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

// What the file may say is not followed: no triggers, no views, no functions but harmless ones.
Status Harden(sqlite3* db);
// Of the last call: kCorrupt, kNoSpace or kIo, with the file's name.
Status Failure(sqlite3* db);
Result<Statement> Prepare(sqlite3* db, const char* sql);
Status Execute(sqlite3* db, const char* sql);
// The one number that a query gives.
Result<std::int64_t> Number(sqlite3* db, const char* sql);

void Bind(sqlite3_stmt* statement, int place, const std::string& text);
void Bind(sqlite3_stmt* statement, int place, std::uint64_t number);
std::string Text(sqlite3_stmt* statement, int column);
std::uint64_t Unsigned(sqlite3_stmt* statement, int column);  // 0 where it is negative

}  // namespace cairn::coordinator::sqlite
