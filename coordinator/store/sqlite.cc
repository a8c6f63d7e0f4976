#include "coordinator/store/sqlite.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn::coordinator::sqlite {
namespace {

constexpr int kPortion = 10'000;  // of steps, between two looks
constexpr std::size_t kMostFoundBytes = 200;

bool IsDamage(int code) {
  return code == SQLITE_CORRUPT || code == SQLITE_NOTADB || code == SQLITE_ERROR || code == SQLITE_TOOBIG ||
         code == SQLITE_INTERRUPT;  // which StepLimit alone does
}

std::string NameOf(sqlite3* db) {
  const char* name = sqlite3_db_filename(db, nullptr);
  return name == nullptr || *name == '\0' ? "job table" : name;
}

Status QuickCheck(sqlite3* db) {
  Result<Statement> prepared = Prepare(db, "PRAGMA quick_check(1);");
  if (!prepared.ok()) return prepared.status();
  if (sqlite3_step(prepared.value().get()) != SQLITE_ROW) return Failure(db);
  const std::string found = Text(prepared.value().get(), 0);
  if (found == "ok") return Status::Ok();
  return {Code::kCorrupt, NameOf(db) + ": damaged: " + Printable(found, kMostFoundBytes)};
}

// Whether the disk gives what is in a file; one that is not there has nothing.
Status ReadThrough(const std::string& path) {
  const Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) return file.status().code() == Code::kNotFound ? Status::Ok() : file.status();
  std::vector<std::byte> buffer(1 << 20);
  for (std::uint64_t at = 0; at < file.value().size(); at += buffer.size()) {
    const std::size_t count = std::min<std::uint64_t>(buffer.size(), file.value().size() - at);
    if (const int error = file.value().ReadAt({buffer.data(), count}, at); error != 0)
      return SystemFailure(path, "cannot be read", error);
  }
  return Status::Ok();
}

}  // namespace

Status Harden(sqlite3* db) {
  for (const auto& [option, on] : {std::pair{SQLITE_DBCONFIG_DEFENSIVE, 1},
                                   {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                   {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
                                   {SQLITE_DBCONFIG_ENABLE_VIEW, 0}})
    if (sqlite3_db_config(db, option, on, nullptr) != SQLITE_OK)
      return {Code::kIo, "this SQLite is too old: it cannot be told to follow nothing that a file says"};
  constexpr int kMostTextBytes = 16 << 20;
  sqlite3_limit(db, SQLITE_LIMIT_LENGTH, kMostTextBytes);
  return Execute(db, "PRAGMA cell_size_check = ON;");
}

StepLimit::StepLimit(sqlite3* db, std::uint64_t most) : db_(db), left_(most / kPortion) {
  sqlite3_progress_handler(db_, kPortion, CountDown, &left_);
}

StepLimit::~StepLimit() { sqlite3_progress_handler(db_, 0, nullptr, nullptr); }

int StepLimit::CountDown(void* left) {
  std::uint64_t& portions = *static_cast<std::uint64_t*>(left);
  if (portions == 0) return 1;
  --portions;
  return 0;
}

// Where the disk fails SQLite calls that damage, too: it is asked whether it can be read, and then once more.
Status CheckPages(sqlite3* db) {
  Status found = QuickCheck(db);
  if (found.code() != Code::kCorrupt) return found;
  for (const char* ending : {"", "-wal"})
    if (Status read = ReadThrough(NameOf(db) + ending); !read.ok()) return read;
  return QuickCheck(db);
}

Status Failure(sqlite3* db, const std::string& opened) {
  const int code = sqlite3_errcode(db) & 0xff;
  const Code kind = IsDamage(code) ? Code::kCorrupt : code == SQLITE_FULL ? Code::kNoSpace : Code::kIo;
  const std::string file = opened.empty() ? NameOf(db) : opened;
  // SQLite calls all of these "disk I/O error", but for the first write that meets a full disk.
  const bool at_disk = code == SQLITE_IOERR || code == SQLITE_FULL || code == SQLITE_CANTOPEN;
  // Where it cannot make a file it tries to read it, and tells that it is not there.
  const bool no_room = code == SQLITE_CANTOPEN && sqlite3_system_errno(db) == ENOENT &&
                       HasNoRoomForFiles(std::filesystem::path(file).parent_path());
  const bool full = no_room || (code == SQLITE_FULL && sqlite3_system_errno(db) == 0);
  const int error = full ? ENOSPC : sqlite3_system_errno(db);
  if (at_disk && error != 0) return SystemFailure(file, "cannot be written or read", error);
  if (code == SQLITE_INTERRUPT)
    return {kind, file + ": damaged: reading it takes more steps than a file of its size needs"};
  return {kind, file + (kind == Code::kCorrupt ? ": damaged: " : ": ") + sqlite3_errmsg(db)};
}

Result<Statement> Prepare(sqlite3* db, const char* sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(db, sql, -1, &statement, nullptr) != SQLITE_OK) return Failure(db);
  return Statement(statement);
}

Status Execute(sqlite3* db, const char* sql) {
  return sqlite3_exec(db, sql, nullptr, nullptr, nullptr) == SQLITE_OK ? Status::Ok() : Failure(db);
}

Result<std::int64_t> Number(sqlite3* db, const char* sql) {
  Result<Statement> prepared = Prepare(db, sql);
  if (!prepared.ok()) return prepared.status();
  if (sqlite3_step(prepared.value().get()) != SQLITE_ROW) return Failure(db);
  return std::int64_t{sqlite3_column_int64(prepared.value().get(), 0)};
}

void Bind(sqlite3_stmt* statement, int place, const std::string& text) {
  sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

void Bind(sqlite3_stmt* statement, int place, std::uint64_t number) {
  sqlite3_bind_int64(statement, place, static_cast<sqlite3_int64>(number));
}

std::string Text(sqlite3_stmt* statement, int column) {
  const unsigned char* text = sqlite3_column_text(statement, column);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

std::uint64_t Unsigned(sqlite3_stmt* statement, int column) {
  const sqlite3_int64 number = sqlite3_column_int64(statement, column);
  return number > 0 ? static_cast<std::uint64_t>(number) : 0;
}

}  // namespace cairn::coordinator::sqlite
