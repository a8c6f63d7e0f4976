#include "coordinator/store/job_log.h"

#include <utility>

#include "coordinator/store/sqlite.h"
#include "schema/text.h"

namespace cairn::coordinator {

void WaitingLines::Add(const std::string& job, wire::LogLine line) {
  JobLines& waiting = by_job_[job];
  waiting.lines.push_back(std::move(line));
  if (waiting.lines.size() <= kLinesKept) return;
  waiting.lines.pop_front();
  ++waiting.gone;
}

std::map<std::string, JobLines> WaitingLines::Take() { return std::exchange(by_job_, {}); }

namespace log_table {
namespace {

using sqlite::Bind;
using sqlite::Statement;

Status Run(sqlite3* db, Statement& statement) {
  const bool done = sqlite3_step(statement.get()) == SQLITE_DONE;
  const Status status = done ? Status::Ok() : sqlite::Failure(db);
  sqlite3_reset(statement.get());
  return status;
}

// Of one row: job, number, utc, level, text.
void IsDamagedLine(sqlite3_context* context, int, sqlite3_value** row) {
  bool damaged = sqlite3_value_type(row[1]) != SQLITE_INTEGER || sqlite3_value_int64(row[1]) < 1;
  for (const int column : {0, 2, 3, 4}) {
    if (damaged || (damaged = sqlite3_value_type(row[column]) != SQLITE_TEXT)) break;
    const auto* bytes = static_cast<const char*>(sqlite3_value_blob(row[column]));
    const std::string text(bytes == nullptr ? "" : bytes,
                           static_cast<std::size_t>(sqlite3_value_bytes(row[column])));
    damaged = (column != 4 && text.empty()) || Printable(text, text.size()) != text;
  }
  sqlite3_result_int(context, damaged ? 1 : 0);
}

Status DefineIsDamagedLine(sqlite3* db) {
  const int defined = sqlite3_create_function_v2(db, "is_damaged_line", 5, SQLITE_UTF8 | SQLITE_DIRECTONLY,
                                                 nullptr, IsDamagedLine, nullptr, nullptr, nullptr);
  return defined == SQLITE_OK ? Status::Ok() : sqlite::Failure(db);
}

class Appender {
 public:
  explicit Appender(sqlite3* db) : db_(db) {}

  Status Prepare() {
    Result<Statement> last = sqlite::Prepare(db_, "SELECT coalesce(max(number), 0) FROM log WHERE job = ?;");
    Result<Statement> insert =
        sqlite::Prepare(db_, "INSERT INTO log (job, number, utc, level, text) VALUES (?1, ?2, ?3, ?4, ?5);");
    Result<Statement> trim = sqlite::Prepare(db_, "DELETE FROM log WHERE job = ?1 AND number <= ?2;");
    for (const Status& status : {last.status(), insert.status(), trim.status()})
      if (!status.ok()) return status;
    last_ = std::move(last).value();
    insert_ = std::move(insert).value();
    trim_ = std::move(trim).value();
    return Status::Ok();
  }

  Status Append(const std::string& job, const JobLines& waiting) {
    Bind(last_.get(), 1, job);
    if (sqlite3_step(last_.get()) != SQLITE_ROW) return sqlite::Failure(db_);
    std::uint64_t number = sqlite::Unsigned(last_.get(), 0) + waiting.gone;
    sqlite3_reset(last_.get());
    Bind(insert_.get(), 1, job);
    for (const wire::LogLine& line : waiting.lines) {
      Bind(insert_.get(), 2, ++number);
      Bind(insert_.get(), 3, line.utc());
      Bind(insert_.get(), 4, line.level());
      Bind(insert_.get(), 5, line.text());
      if (const Status status = Run(db_, insert_); !status.ok()) return status;
    }
    if (number <= kLinesKept) return Status::Ok();
    Bind(trim_.get(), 1, job);
    Bind(trim_.get(), 2, number - kLinesKept);
    return Run(db_, trim_);
  }

 private:
  sqlite3* db_;
  Statement last_, insert_, trim_;
};

}  // namespace

const char* const kMake = R"sql(
  CREATE TABLE log (job TEXT NOT NULL, number INTEGER NOT NULL, utc TEXT NOT NULL, level TEXT NOT NULL,
                    text TEXT NOT NULL, PRIMARY KEY (job, number)) WITHOUT ROWID;
)sql";

Status Append(sqlite3* db, const std::map<std::string, JobLines>& by_job) {
  Appender appender(db);
  Status status = appender.Prepare();
  if (status.ok()) status = sqlite::Execute(db, "BEGIN IMMEDIATE;");
  if (!status.ok()) return status;
  for (const auto& [job, waiting] : by_job)
    if (status.ok()) status = appender.Append(job, waiting);
  if (status.ok()) status = sqlite::Execute(db, "COMMIT;");
  if (!status.ok()) static_cast<void>(sqlite::Execute(db, "ROLLBACK;"));
  return status;
}

Result<std::vector<wire::LogLine>> Read(sqlite3* db, const std::string& job, std::uint64_t after) {
  Result<Statement> prepared = sqlite::Prepare(
      db, "SELECT number, utc, level, text FROM log WHERE job = ? AND number > ? ORDER BY number LIMIT ?;");
  if (!prepared.ok()) return prepared.status();
  sqlite3_stmt* statement = prepared.value().get();
  Bind(statement, 1, job);
  Bind(statement, 2, after);
  Bind(statement, 3, std::uint64_t{kLinesKept});  // more are none of ours
  std::vector<wire::LogLine> lines;
  int step = SQLITE_ROW;
  while ((step = sqlite3_step(statement)) == SQLITE_ROW) {
    wire::LogLine& line = lines.emplace_back();
    line.set_number(sqlite::Unsigned(statement, 0));
    // SQLite's pages have no checksums: what a bad disk made of a text must still fit into a message.
    line.set_utc(Printable(sqlite::Text(statement, 1), kLogLineBytes));
    line.set_level(Printable(sqlite::Text(statement, 2), kLogLineBytes));
    line.set_text(Printable(sqlite::Text(statement, 3), kLogLineBytes));
  }
  if (step != SQLITE_DONE) return sqlite::Failure(db);
  return lines;
}

Status Remove(sqlite3* db, const std::string& job) {
  Result<Statement> prepared = sqlite::Prepare(db, "DELETE FROM log WHERE job = ?;");
  if (!prepared.ok()) return prepared.status();
  Bind(prepared.value().get(), 1, job);
  return Run(db, prepared.value());
}

// From one to the next by the key, for a job may have two thousand lines.
Result<std::vector<std::string>> Jobs(sqlite3* db) {
  Result<Statement> prepared = sqlite::Prepare(db, "SELECT job FROM log WHERE job > ? ORDER BY job LIMIT 1;");
  if (!prepared.ok()) return prepared.status();
  sqlite3_stmt* statement = prepared.value().get();
  std::vector<std::string> jobs;
  int step = SQLITE_ROW;
  while (true) {
    Bind(statement, 1, jobs.empty() ? "" : jobs.back());
    if ((step = sqlite3_step(statement)) != SQLITE_ROW) break;
    std::string job = sqlite::Text(statement, 0);
    sqlite3_reset(statement);
    // What a bad disk made of one may be no text, or stand in the wrong place.
    if (job <= (jobs.empty() ? "" : jobs.back()))
      return Status(Code::kCorrupt,
                    std::string(sqlite3_db_filename(db, nullptr)) + ": its lines are not in order");
    jobs.push_back(std::move(job));
  }
  if (step != SQLITE_DONE) return sqlite::Failure(db);
  return jobs;
}

Result<DamagedLines> FindDamaged(sqlite3* db) {
  if (Status status = DefineIsDamagedLine(db); !status.ok()) return status;
  Result<Statement> prepared = sqlite::Prepare(
      db, "SELECT count(*), min(job) FROM log WHERE is_damaged_line(job, number, utc, level, text);");
  if (!prepared.ok()) return prepared.status();
  if (sqlite3_step(prepared.value().get()) != SQLITE_ROW) return sqlite::Failure(db);
  constexpr std::size_t kMostBytes = 100;
  return DamagedLines{sqlite::Unsigned(prepared.value().get(), 0),
                      Printable(sqlite::Text(prepared.value().get(), 1), kMostBytes)};
}

Status RemoveDamaged(sqlite3* db) {
  if (Status status = DefineIsDamagedLine(db); !status.ok()) return status;
  return sqlite::Execute(db, "DELETE FROM log WHERE is_damaged_line(job, number, utc, level, text);");
}

}  // namespace log_table
}  // namespace cairn::coordinator
