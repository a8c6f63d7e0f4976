#include "coordinator/store/job_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <utility>

#include "coordinator/store/sqlite.h"
#include "schema/store/atomic_file.h"
#include "schema/text.h"

namespace cairn::coordinator {
namespace {

constexpr int kVersion = 4;  // in the file's user_version; version 1 left it 0

// WAL: readers are never in the way, and a crash loses at most the last lines.
constexpr const char* kOpen = "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;";
constexpr const char* kVersion1 = R"sql(
  CREATE TABLE IF NOT EXISTS jobs (id TEXT PRIMARY KEY);
)sql";
constexpr const char* kVersion2 = R"sql(
  CREATE TABLE last_removed (one INTEGER PRIMARY KEY CHECK (one = 1), number INTEGER NOT NULL);
  INSERT INTO last_removed VALUES (1, 0);
)sql";
// Until then the table had a row a job as well.
constexpr const char* kVersion4 = R"sql(
  ALTER TABLE last_removed RENAME TO last_number;
  UPDATE last_number SET number =
    max(number, (SELECT coalesce(max(CAST(id AS INTEGER)), 0) FROM jobs),
                (SELECT coalesce(max(CAST(job AS INTEGER)), 0) FROM log));
  DROP TABLE jobs;
)sql";

// The tables of all versions, as SQLite keeps the statements that made them.
constexpr std::array<const char*, 4> kTables = {
    "CREATE TABLE jobs ( id TEXT PRIMARY KEY, name TEXT NOT NULL, state TEXT NOT NULL, reason TEXT NOT NULL, "
    "stage INTEGER NOT NULL, stages INTEGER NOT NULL, round INTEGER NOT NULL, note TEXT NOT NULL, "
    "input_error INTEGER NOT NULL, seconds REAL NOT NULL, "
    "submitted_utc TEXT NOT NULL, updated_utc TEXT NOT NULL)",
    "CREATE TABLE last_removed (one INTEGER PRIMARY KEY CHECK (one = 1), number INTEGER NOT NULL)",
    "CREATE TABLE \"last_number\" (one INTEGER PRIMARY KEY CHECK (one = 1), number INTEGER NOT NULL)",
    "CREATE TABLE log (job TEXT NOT NULL, number INTEGER NOT NULL, utc TEXT NOT NULL, level TEXT NOT NULL, "
    "text TEXT NOT NULL, PRIMARY KEY (job, number)) WITHOUT ROWID"};

std::string WithSingleSpaces(const std::string& sql) {
  std::string text;
  for (const char c : sql) {
    const bool space = c == ' ' || c == '\n';
    if (!space || !text.ends_with(' ')) text += space ? ' ' : c;
  }
  return text;
}

// Whoever hands on a store must not choose what is computed when it is served: a trigger, say, or a view that
// never ends. Asked before anything else of what the file holds.
Status CheckTables(sqlite3* db) {
  Result<sqlite::Statement> prepared =
      sqlite::Prepare(db, "SELECT name, coalesce(sql, '') FROM sqlite_master;");
  if (!prepared.ok()) return prepared.status();
  int step = SQLITE_OK;
  while ((step = sqlite3_step(prepared.value().get())) == SQLITE_ROW) {
    const std::string name = sqlite::Text(prepared.value().get(), 0);
    const std::string sql = WithSingleSpaces(sqlite::Text(prepared.value().get(), 1));
    const bool ours =
        name == "sqlite_autoindex_jobs_1" ? sql.empty() : std::ranges::find(kTables, sql) != kTables.end();
    if (!ours)
      return {Code::kCorrupt, std::string(sqlite3_db_filename(db, nullptr)) + ": it holds '" +
                                  Escaped(CutTo(name, 100)) + "', which is none of a job table's"};
  }
  return step == SQLITE_DONE ? Status::Ok() : sqlite::Failure(db);
}

// The list of tables is short, and each row of one that has no end costs the parsing of a statement.
Status CheckVersionAndTables(sqlite3* db) {
  constexpr std::uint64_t kSteps = 200'000;
  const sqlite::StepLimit limit(db, kSteps);
  const Result<std::int64_t> version = sqlite::Number(db, "PRAGMA user_version;");
  if (!version.ok()) return version.status();
  if (version.value() > kVersion)
    return {Code::kVersion, std::string(sqlite3_db_filename(db, nullptr)) + ": a job table of version " +
                                std::to_string(version.value()) +
                                ", of a newer Cairn; this one knows version " + std::to_string(kVersion)};
  return CheckTables(db);
}

// A thousand times what the lines of a job need.
constexpr std::uint64_t kMostSteps = 50'000'000;

// Enough to look at every row that such a file may hold a few times.
std::uint64_t StepsFor(const std::filesystem::path& path) {
  constexpr std::uint64_t kStepsAByte = 8;
  std::uint64_t bytes = 0;
  for (const char* ending : {"", "-wal"}) {
    std::error_code missing;
    const std::uintmax_t size = std::filesystem::file_size(path.string() + ending, missing);
    if (!missing) bytes += size;
  }
  return kMostSteps + kStepsAByte * bytes;
}

// Of a whole path, whatever is in it.
std::string UriOf(const std::string& path) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string uri = "file:";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = std::isalnum(byte) != 0 || std::string_view("/._-").find(c) != std::string_view::npos;
    uri += plain ? std::string(1, c) : std::string{'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return uri;
}

// What is damaged while it is in use shows when it is read. The next start makes it anew.
Status WithAdvice(const Status& status) {
  if (status.code() != Code::kCorrupt) return status;
  return {Code::kCorrupt, status.message() +
                              "; start the coordinator again: it makes the table anew, without the logs of "
                              "jobs, which go on"};
}

}  // namespace

std::uint64_t NumberOfJob(const std::string& id) {
  std::int64_t number = 0;
  std::from_chars(id.data(), id.data() + id.size(), number);
  return number > 0 ? static_cast<std::uint64_t>(number) : 0;
}

void JobTable::Close::operator()(sqlite3* db) const { sqlite3_close(db); }

Result<JobTable> JobTable::OpenUnchecked(const std::filesystem::path& path) {
  JobTable table;
  sqlite3* db = nullptr;
  const int opened = sqlite3_open(path.c_str(), &db);
  table.db_.reset(db);
  if (opened != SQLITE_OK && db != nullptr) return sqlite::Failure(db, path.string());
  if (opened != SQLITE_OK) return Status(Code::kIo, path.string() + ": " + sqlite3_errstr(opened));
  if (Status status = sqlite::Harden(db); !status.ok()) return status;
  return table;
}

Result<JobTable> JobTable::Open(const std::filesystem::path& path) {
  Result<JobTable> opened = OpenUnchecked(path);
  if (!opened.ok()) return opened;
  JobTable& table = opened.value();
  sqlite3* db = table.db_.get();
  if (Status status = CheckVersionAndTables(db); !status.ok()) return status;
  const sqlite::StepLimit limit(db, StepsFor(path));
  if (Status status = table.MakeOrUpgrade(); !status.ok()) return status;
  // A file without it is not ours.
  const Result<std::int64_t> last = sqlite::Number(db, "SELECT number FROM last_number;");
  if (!last.ok()) return last.status();
  table.last_number_ = static_cast<std::uint64_t>(std::max<std::int64_t>(last.value(), 0));
  Result<log_table::DamagedLines> damaged = log_table::FindDamaged(db);
  if (!damaged.ok()) return damaged.status();
  table.damaged_lines_ = std::move(damaged).value();
  return opened;
}

std::uint64_t JobTable::LastNumberIn(const std::filesystem::path& path) {
  const Result<JobTable> table = OpenUnchecked(path);
  if (!table.ok()) return 0;
  sqlite3* db = table.value().db_.get();
  if (!CheckVersionAndTables(db).ok()) return 0;
  const sqlite::StepLimit limit(db, kMostSteps);
  const Result<std::int64_t> last = sqlite::Number(db, "SELECT number FROM last_number;");
  return last.ok() ? static_cast<std::uint64_t>(std::max<std::int64_t>(last.value(), 0)) : 0;
}

Status JobTable::RemoveDamagedLines() {
  const sqlite::StepLimit limit(db_.get(), StepsFor(sqlite3_db_filename(db_.get(), nullptr)));
  damaged_lines_ = {};
  return log_table::RemoveDamaged(db_.get());
}

Result<log_table::DamagedLines> JobTable::DamagedLinesOfCopy(
    const std::filesystem::path& copy, bool remove, const std::function<bool(const std::string& job)>& keep) {
  Result<JobTable> table = Open(copy);
  if (!table.ok()) return table.status();
  log_table::DamagedLines damaged = table.value().damaged_lines();
  if (damaged.count > 0 && remove)
    if (Status status = table.value().RemoveDamagedLines(); !status.ok()) return status;
  if (damaged.count > 0 && !remove) return damaged;
  const Result<std::vector<std::string>> jobs = log_table::Jobs(table.value().db_.get());
  if (!jobs.ok()) return jobs.status();
  for (const std::string& job : jobs.value())
    if (Status status = keep(job) ? Status::Ok() : table.value().Remove(job); !status.ok()) return status;
  return damaged;
}

Result<JobTable> JobTable::OpenToRead(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::exists(path, error)) return Status(Code::kNotFound, path.string() + " is not there");
  for (const char* ending : {"", "-wal", "-shm", "-journal"}) {  // SQLite would wait for ever on a FIFO
    const fs::file_status there = fs::symlink_status(path.string() + ending, error);
    if (fs::exists(there) && !fs::is_regular_file(there))
      return Status(Code::kCorrupt, path.string() + ending + " is no file");
  }
  JobTable table;
  sqlite3* db = nullptr;
  // A table without a journal beside it is nobody's now: it is read as it lies, also where nothing may be
  // written.
  const bool at_rest = !fs::exists(path.string() + "-wal", error);
  const std::string uri = UriOf(fs::absolute(path).string()) + (at_rest ? "?immutable=1" : "");
  const int opened = sqlite3_open_v2(uri.c_str(), &db, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  table.db_.reset(db);
  if (opened != SQLITE_OK) return Status(Code::kCorrupt, path.string() + ": " + sqlite3_errstr(opened));
  constexpr int kPatience_ms = 10'000;
  sqlite3_busy_timeout(db, kPatience_ms);
  return table;
}

Result<std::vector<std::string>> JobTable::JobsWithLogIn(const std::filesystem::path& path) {
  const Result<JobTable> table = OpenToRead(path);
  if (!table.ok()) return table.status();
  sqlite3* db = table.value().db_.get();
  if (Status status = sqlite::Harden(db); !status.ok()) return status;
  if (Status status = CheckVersionAndTables(db); !status.ok()) return status;
  const Result<std::int64_t> version = sqlite::Number(db, "PRAGMA user_version;");
  if (!version.ok()) return version.status();
  if (version.value() < 3) return std::vector<std::string>();  // it has no logs yet
  const sqlite::StepLimit limit(db, StepsFor(path));
  return log_table::Jobs(db);
}

Status JobTable::Copy(const std::filesystem::path& from, const std::filesystem::path& to,
                      const std::function<bool(const std::string& job)>& keep) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path part = to.parent_path() / "uploads" / "table.part";  // which the next owner removes
  const auto remove = [](const fs::path& file) {
    std::error_code ignored;
    for (const char* ending : {"", "-wal", "-shm", "-journal"}) fs::remove(file.string() + ending, ignored);
  };
  remove(part);
  {
    const Result<JobTable> source = OpenToRead(from);
    if (!source.ok()) return source.status();
    Result<JobTable> made = OpenUnchecked(part);
    if (!made.ok()) return made.status();
    const JobTable target = std::move(made).value();
    sqlite3_backup* const backup =
        sqlite3_backup_init(target.db_.get(), "main", source.value().db_.get(), "main");
    if (backup == nullptr) return sqlite::Failure(target.db_.get());
    sqlite3_backup_step(backup, -1);
    const int copied = sqlite3_backup_finish(backup);
    if (copied == SQLITE_CORRUPT || copied == SQLITE_NOTADB)
      return {Code::kCorrupt, from.string() + ": " + sqlite3_errstr(copied)};
    if (copied != SQLITE_OK) return sqlite::Failure(target.db_.get(), part.string());
  }
  const bool replaces = fs::exists(to, error);
  const Result<log_table::DamagedLines> damaged = DamagedLinesOfCopy(part, !replaces, keep);
  Status whole = damaged.status();
  if (damaged.ok() && damaged.value().count > 0)
    whole = {Code::kCorrupt, from.string() + ": damaged lines: " + std::to_string(damaged.value().count) +
                                 ", of job '" + damaged.value().job + "' for one" +
                                 (replaces ? "; start the coordinator again: it removes them" : "")};
  if (!damaged.ok() || (!whole.ok() && replaces)) {  // what an earlier copy has may be whole
    remove(part);
    return whole;
  }
  for (const char* ending : {"-wal", "-shm", "-journal"}) fs::remove(to.string() + ending, error);
  fs::rename(part, to, error);
  if (error) return SystemFailure(to, "rename", error.value());
  const Status synced = SyncFolder(to.parent_path());
  return synced.ok() ? whole : synced;
}

// All or nothing.
Status JobTable::MakeOrUpgrade() const {
  const Result<std::int64_t> version = sqlite::Number(db_.get(), "PRAGMA user_version;");
  if (!version.ok()) return version.status();
  Status status = sqlite::CheckPages(db_.get());
  if (status.ok()) status = Execute(kOpen);
  if (!status.ok() || version.value() == kVersion) return status;
  status = Execute("BEGIN IMMEDIATE;");
  if (status.ok() && version.value() < 2) status = Execute(kVersion1);
  if (status.ok() && version.value() < 2) status = Execute(kVersion2);
  if (status.ok() && version.value() < 3) status = Execute(log_table::kMake);
  if (status.ok()) status = Execute(kVersion4);
  if (status.ok()) status = Execute(("PRAGMA user_version = " + std::to_string(kVersion) + ";").c_str());
  if (status.ok()) return Execute("COMMIT;");
  static_cast<void>(Execute("ROLLBACK;"));
  return status;
}

Status JobTable::Execute(const char* sql) const { return sqlite::Execute(db_.get(), sql); }

Status JobTable::NoteNumber(const std::string& job) {
  const std::uint64_t number = NumberOfJob(job);
  if (number <= last_number_) return Status::Ok();
  last_number_ = number;
  return Execute(("UPDATE last_number SET number = max(number, " + std::to_string(number) + ");").c_str());
}

Status JobTable::Remove(const std::string& job) {
  const sqlite::StepLimit limit(db_.get(), kMostSteps);
  return WithAdvice(log_table::Remove(db_.get(), job));
}

void JobTable::LeaveAsItIs() const {
  sqlite3_db_config(db_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
}

// No checkpoint will tell this number any more. With FULL a commit is synced.
Status JobTable::NoteRemoval(const std::string& job) {
  last_number_ = std::max(last_number_, NumberOfJob(job));
  const std::string number = std::to_string(last_number_);
  Status status = Execute(
      ("PRAGMA synchronous = FULL; UPDATE last_number SET number = max(number, " + number + ");").c_str());
  if (status.ok()) status = Remove(job);
  const Status normal = Execute("PRAGMA synchronous = NORMAL;");
  return status.ok() ? normal : status;
}

Status JobTable::AppendLog(const std::map<std::string, JobLines>& by_job) {
  const sqlite::StepLimit limit(db_.get(), kMostSteps * (1 + by_job.size()));
  return WithAdvice(log_table::Append(db_.get(), by_job));
}

Result<std::vector<wire::LogLine>> JobTable::ReadLog(const std::string& job, std::uint64_t after) const {
  const sqlite::StepLimit limit(db_.get(), kMostSteps);
  Result<std::vector<wire::LogLine>> lines = log_table::Read(db_.get(), job, after);
  if (!lines.ok()) return WithAdvice(lines.status());
  return lines;
}

}  // namespace cairn::coordinator
