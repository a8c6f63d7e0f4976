// The job table: of jobs what no checkpoint tells, their logs and the highest number that one ever had. One
// that is lost or damaged is made anew, without the logs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/store/job_log.h"
#include "schema/error.h"
#include "schema/wire.pb.h"

struct sqlite3;

namespace cairn::coordinator {

// What the id of a job begins with: 7 of `7-museum`; 0: no number, or one that no table can hold.
std::uint64_t NumberOfJob(const std::string& id);
// Of what is taken back as a job: jobs after it need numbers too, and JSON's readers know none above exactly.
inline constexpr std::uint64_t kMostJobNumber = std::uint64_t{1} << 53;

// For one thread.
class JobTable {
 public:
  // Opens or makes the file; one of an earlier version is upgraded. Takes time in proportion to the file,
  // whatever is in it.
  // kCorrupt: it is not a job table, or damaged.
  // kVersion: of a later version; then it is not touched.
  static Result<JobTable> Open(const std::filesystem::path& path);
  // LastNumber() of a table that may be damaged; 0 where it cannot be told.
  static std::uint64_t LastNumberIn(const std::filesystem::path& path);
  // Those that have a log, sorted, of a table that another process may have open. kCorrupt: it cannot be
  // read.
  static Result<std::vector<std::string>> JobsWithLogIn(const std::filesystem::path& path);
  // A copy of a table that another process may have open, in the place of what is at `to`; whole or not at
  // all. Only read there; what is in it is looked at by Open. kNotFound; kCorrupt: also of damaged lines,
  // which are then left out, or, where there is a copy already, it stays.
  // `keep`: whose logs.
  static Status Copy(const std::filesystem::path& from, const std::filesystem::path& to,
                     const std::function<bool(const std::string& job)>& keep);
  JobTable(JobTable&&) noexcept = default;
  JobTable& operator=(JobTable&&) noexcept = default;

  // When a job is durable.
  Status NoteNumber(const std::string& job);
  // Before a job's checkpoints go. Durable when it returns, so that the job's number is never used again, and
  // that it has no log, by which it would be taken for lost (LostJobs in recovery.h).
  Status NoteRemoval(const std::string& job);
  // Its log.
  Status Remove(const std::string& job);
  // The highest number that the id of a job began with.
  std::uint64_t LastNumber() const { return last_number_; }
  // The table is another machine's: what ends here writes nothing, as SQLite else does.
  void LeaveAsItIs() const;
  // job_log.h
  const log_table::DamagedLines& damaged_lines() const { return damaged_lines_; }  // when it was opened
  Status RemoveDamagedLines();
  Status AppendLog(const std::map<std::string, JobLines>& by_job);
  Result<std::vector<wire::LogLine>> ReadLog(const std::string& job, std::uint64_t after) const;

 private:
  struct Close {
    void operator()(sqlite3* db) const;
  };
  JobTable() = default;
  static Result<JobTable> OpenUnchecked(const std::filesystem::path& path);
  static Result<JobTable> OpenToRead(const std::filesystem::path& path);
  static Result<log_table::DamagedLines> DamagedLinesOfCopy(
      const std::filesystem::path& copy, bool remove,
      const std::function<bool(const std::string& job)>& keep);
  Status Execute(const char* sql) const;
  Status MakeOrUpgrade() const;

  std::unique_ptr<sqlite3, Close> db_;
  std::uint64_t last_number_ = 0;
  log_table::DamagedLines damaged_lines_;
};

}  // namespace cairn::coordinator
