// The logs of jobs: what happened to each, a line an event. The newest lines of a job are kept, in a table of
// the job table's file; those that the cap pushes out show in the first number that is left.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "schema/error.h"
#include "schema/wire.pb.h"

struct sqlite3;

namespace cairn::coordinator {

inline constexpr std::size_t kLinesKept = 2000;  // of a job; the oldest go
inline constexpr std::size_t kLogLineBytes = 2000;

// Lines of one job that wait to be written, in their order. They get their numbers when they are.
struct JobLines {
  std::uint64_t gone = 0;  // came before these, and were pushed out before they were written
  std::deque<wire::LogLine> lines;
};

// What waits, by job: many lines go to the disk at once. Bounded by kLinesKept a job.
class WaitingLines {
 public:
  void Add(const std::string& job, wire::LogLine line);
  void Forget(const std::string& job) { by_job_.erase(job); }
  bool empty() const { return by_job_.empty(); }
  std::map<std::string, JobLines> Take();

 private:
  std::map<std::string, JobLines> by_job_;
};

// Of the SQLite file that `db` is. Lines are numbered from 1 in each job.
namespace log_table {

extern const char* const kMake;  // SQL

Status Append(sqlite3* db, const std::map<std::string, JobLines>& by_job);  // all or nothing
// Those of numbers above `after`.
Result<std::vector<wire::LogLine>> Read(sqlite3* db, const std::string& job, std::uint64_t after);
Status Remove(sqlite3* db, const std::string& job);
Result<std::vector<std::string>> Jobs(sqlite3* db);  // that have lines, sorted by their bytes

// Lines that no coordinator wrote, as a bad disk makes them: whose number is none, or whose texts are none,
// or hold what no line does. SQLite's own checks look at the tree of pages, not at what the rows say; a
// letter that has become another shows to nobody.
struct DamagedLines {
  std::uint64_t count = 0;
  std::string job;  // of one of them, Printable
};
Result<DamagedLines> FindDamaged(sqlite3* db);
Status RemoveDamaged(sqlite3* db);

}  // namespace log_table
}  // namespace cairn::coordinator
