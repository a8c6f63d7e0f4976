#include "coordinator/store/job_table.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "coordinator/store/sqlite.h"

namespace cairn::coordinator {
namespace {

constexpr int kVersion = 3;  // in the file's user_version; version 1 left it 0

// WAL: readers are never in the way, and a crash loses at most the last rows, which the checkpoints have too.
constexpr const char* kOpen = "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;";
constexpr const char* kVersion1 = R"sql(
  CREATE TABLE IF NOT EXISTS jobs (
    id TEXT PRIMARY KEY, name TEXT NOT NULL, state TEXT NOT NULL, reason TEXT NOT NULL,
    stage INTEGER NOT NULL, stages INTEGER NOT NULL, round INTEGER NOT NULL, note TEXT NOT NULL,
    input_error INTEGER NOT NULL, seconds REAL NOT NULL,
    submitted_utc TEXT NOT NULL, updated_utc TEXT NOT NULL);
)sql";
constexpr const char* kVersion2 = R"sql(
  CREATE TABLE last_removed (one INTEGER PRIMARY KEY CHECK (one = 1), number INTEGER NOT NULL);
  INSERT INTO last_removed VALUES (1, 0);
)sql";

constexpr const char* kWrite = R"sql(
  INSERT INTO jobs (id, name, state, reason, stage, stages, round, note, input_error, seconds, submitted_utc,
                    updated_utc)
  VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)
  ON CONFLICT (id) DO UPDATE SET
    name = excluded.name, state = excluded.state, reason = excluded.reason, stage = excluded.stage,
    stages = excluded.stages, round = excluded.round, note = excluded.note, input_error = excluded.input_error,
    seconds = excluded.seconds, updated_utc = excluded.updated_utc;
)sql";

constexpr const char* kRead = R"sql(
  SELECT id, name, state, reason, stage, stages, round, note, input_error, seconds, submitted_utc, updated_utc
  FROM jobs ORDER BY id;
)sql";

using sqlite::Bind;
using sqlite::Statement;
using sqlite::Text;

}  // namespace

std::uint64_t NumberOfJob(const std::string& id) {
  std::int64_t number = 0;
  std::from_chars(id.data(), id.data() + id.size(), number);
  return number > 0 ? static_cast<std::uint64_t>(number) : 0;
}

void JobTable::Close::operator()(sqlite3* db) const { sqlite3_close(db); }

Result<JobTable> JobTable::Open(const std::filesystem::path& path) {
  JobTable table;
  sqlite3* db = nullptr;
  const int opened = sqlite3_open(path.c_str(), &db);
  table.db_.reset(db);
  if (opened != SQLITE_OK && db != nullptr) return sqlite::Failure(db);
  if (opened != SQLITE_OK) return Status(Code::kIo, path.string() + ": " + sqlite3_errstr(opened));
  if (Status status = table.MakeOrUpgrade(); !status.ok()) return status;
  // A table of that name with other columns is not ours.
  if (Result<Statement> read = sqlite::Prepare(db, kRead); !read.ok()) return read.status();
  return table;
}

// All or nothing.
Status JobTable::MakeOrUpgrade() const {
  const Result<std::int64_t> version = sqlite::Number(db_.get(), "PRAGMA user_version;");
  if (!version.ok()) return version.status();
  if (version.value() > kVersion)
    return {Code::kVersion, std::string(sqlite3_db_filename(db_.get(), nullptr)) +
                                ": a job table of version " + std::to_string(version.value()) +
                                ", of a newer Cairn; this one knows version " + std::to_string(kVersion)};
  Status status = Execute(kOpen);
  if (!status.ok() || version.value() == kVersion) return status;
  status = Execute("BEGIN IMMEDIATE;");
  if (status.ok() && version.value() < 2) status = Execute(kVersion1);
  if (status.ok() && version.value() < 2) status = Execute(kVersion2);
  if (status.ok()) status = Execute(log_table::kMake);  // version 3
  if (status.ok()) status = Execute(("PRAGMA user_version = " + std::to_string(kVersion) + ";").c_str());
  if (status.ok()) return Execute("COMMIT;");
  static_cast<void>(Execute("ROLLBACK;"));
  return status;
}

Status JobTable::Execute(const char* sql) const { return sqlite::Execute(db_.get(), sql); }

Status JobTable::Write(const JobRow& row) {
  Result<Statement> prepared = sqlite::Prepare(db_.get(), kWrite);
  if (!prepared.ok()) return prepared.status();
  sqlite3_stmt* statement = prepared.value().get();
  int column = 0;
  const auto text = [&](const std::string& value) { Bind(statement, ++column, value); };
  const auto number = [&](std::uint64_t value) { Bind(statement, ++column, value); };
  const wire::JobInfo& info = row.info;
  text(info.id());
  text(info.name());
  text(info.state());
  text(info.reason());
  number(info.stage());
  number(info.stages());
  number(info.round());
  text(info.note());
  number(info.input_error() ? 1u : 0u);
  sqlite3_bind_double(statement, ++column, info.seconds());
  text(row.submitted_utc);
  text(row.updated_utc);
  return sqlite3_step(statement) == SQLITE_DONE ? Status::Ok() : sqlite::Failure(db_.get());
}

Status JobTable::Remove(const std::string& job) {
  Result<Statement> prepared = sqlite::Prepare(db_.get(), "DELETE FROM jobs WHERE id = ?;");
  if (!prepared.ok()) return prepared.status();
  sqlite3_stmt* statement = prepared.value().get();
  Bind(statement, 1, job);
  if (sqlite3_step(statement) != SQLITE_DONE) return sqlite::Failure(db_.get());
  return log_table::Remove(db_.get(), job);
}

// No checkpoint will tell this number any more. With FULL a commit is synced.
Status JobTable::NoteRemoval(const std::string& job) {
  const std::string number = std::to_string(NumberOfJob(job));
  Status status = Execute(
      ("PRAGMA synchronous = FULL; UPDATE last_removed SET number = max(number, " + number + ");").c_str());
  const Status normal = Execute("PRAGMA synchronous = NORMAL;");
  return status.ok() ? normal : status;
}

Result<std::uint64_t> JobTable::LastNumber() const {
  const Result<std::int64_t> number =
      sqlite::Number(db_.get(),
                     "SELECT max((SELECT number FROM last_removed), (SELECT coalesce(max(CAST(id AS "
                     "INTEGER)), 0) FROM jobs), "
                     "(SELECT coalesce(max(CAST(job AS INTEGER)), 0) FROM log));");
  if (!number.ok()) return number.status();
  return static_cast<std::uint64_t>(std::max<std::int64_t>(number.value(), 0));
}

Result<std::vector<JobRow>> JobTable::Read() const {
  Result<Statement> prepared = sqlite::Prepare(db_.get(), kRead);
  if (!prepared.ok()) return prepared.status();
  sqlite3_stmt* statement = prepared.value().get();
  std::vector<JobRow> rows;
  int step = SQLITE_ROW;
  while ((step = sqlite3_step(statement)) == SQLITE_ROW) {
    JobRow row;
    row.info.set_id(Text(statement, 0));
    row.info.set_name(Text(statement, 1));
    row.info.set_state(Text(statement, 2));
    row.info.set_reason(Text(statement, 3));
    row.info.set_stage(static_cast<std::uint32_t>(sqlite3_column_int64(statement, 4)));
    row.info.set_stages(static_cast<std::uint32_t>(sqlite3_column_int64(statement, 5)));
    row.info.set_round(static_cast<std::uint64_t>(sqlite3_column_int64(statement, 6)));
    row.info.set_note(Text(statement, 7));
    row.info.set_input_error(sqlite3_column_int64(statement, 8) != 0);
    row.info.set_seconds(sqlite3_column_double(statement, 9));
    row.submitted_utc = Text(statement, 10);
    row.updated_utc = Text(statement, 11);
    rows.push_back(std::move(row));
  }
  if (step != SQLITE_DONE) return sqlite::Failure(db_.get());
  return rows;
}

Status JobTable::AppendLog(const std::map<std::string, JobLines>& by_job) {
  return log_table::Append(db_.get(), by_job);
}

Result<std::vector<wire::LogLine>> JobTable::ReadLog(const std::string& job, std::uint64_t after) const {
  return log_table::Read(db_.get(), job, after);
}

}  // namespace cairn::coordinator
