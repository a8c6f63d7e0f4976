// The job table: what jobs there are, where they stand, and their logs, for people and their tools. The
// checkpoints are the truth; a table that is lost or damaged is made anew from them, without the logs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/store/job_log.h"
#include "schema/error.h"
#include "schema/wire.pb.h"

struct sqlite3;

namespace cairn::coordinator {

struct JobRow {
  wire::JobInfo info;
  std::string submitted_utc;  // kept from the first time that a job is written
  std::string updated_utc;
};

// What the id of a job begins with: 7 of `7-museum`; 0: no number.
std::uint64_t NumberOfJob(const std::string& id);

// For one thread.
class JobTable {
 public:
  // Opens or makes the file; one of an earlier version is upgraded.
  // kCorrupt: it is not a job table, or damaged.
  // kVersion: of a later version; then it is not touched.
  static Result<JobTable> Open(const std::filesystem::path& path);
  JobTable(JobTable&&) noexcept = default;
  JobTable& operator=(JobTable&&) noexcept = default;

  // Inserts or replaces a job's row, but for submitted_utc.
  Status Write(const JobRow& row);
  // Before a job's checkpoints go. Durable when it returns, so that the job's number is never used again.
  Status NoteRemoval(const std::string& job);
  // Its row and its log.
  Status Remove(const std::string& job);
  // The highest number that the id of a job began with which is in the table, or was removed.
  Result<std::uint64_t> LastNumber() const;
  Result<std::vector<JobRow>> Read() const;  // by id
  // job_log.h
  Status AppendLog(const std::map<std::string, JobLines>& by_job);
  Result<std::vector<wire::LogLine>> ReadLog(const std::string& job, std::uint64_t after) const;

 private:
  struct Close {
    void operator()(sqlite3* db) const;
  };
  JobTable() = default;
  Status Execute(const char* sql) const;
  Status MakeOrUpgrade() const;

  std::unique_ptr<sqlite3, Close> db_;
};

}  // namespace cairn::coordinator
