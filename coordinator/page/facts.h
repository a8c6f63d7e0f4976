// What a page is made of: what the coordinator said last, for all who look on.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/client.h"
#include "coordinator/page/rounds.h"

namespace cairn::page {

// What a worker did, as far as who asks now and then can tell.
struct TaskSpan {
  std::string job, task;
  double begin_s = 0, end_s = 0;  // of the page's own clock
};

// The last minutes of all workers, as their answers told them.
class FleetTimes {
 public:
  static constexpr double kKept_s = 120;

  struct OfWorker {
    std::string name;
    std::deque<TaskSpan> spans;
  };

  void Add(const std::vector<wire::WorkerInfo>& workers, double now_s);
  const std::map<std::uint64_t, OfWorker>& workers() const { return workers_; }
  double now_s() const { return now_s_; }

 private:
  std::map<std::uint64_t, OfWorker> workers_;  // those that are connected
  double now_s_ = 0;
};

struct Facts {
  std::uint64_t number = 0;  // another each time that something was asked
  bool known = false;        // the coordinator has answered once
  // Those that are not over first, of each the latest first. Shared: it is long, and asked for more rarely
  // than all else.
  std::shared_ptr<coordinator::JobList> list = std::make_shared<coordinator::JobList>();
  std::map<std::string, wire::JobInfo> newer;  // of jobs that somebody looks at: as they stand since
  std::vector<wire::WorkerInfo> workers;
  FleetTimes times;
  std::string utc;      // when that was
  std::string trouble;  // why that is not now, a sentence; empty: it is

  const wire::JobInfo* Find(const std::string& job) const;
};
using FactsPtr = std::shared_ptr<const Facts>;
using HistoryPtr = std::shared_ptr<const JobHistory>;

bool IsOver(const wire::JobInfo& job);
// So many of its stages have a result.
std::uint32_t StagesDone(const wire::JobInfo& job);
// Of its stage, 0 to 1; -1: unknown.
double PartDone(const wire::JobInfo& job);
// "0:40", "0:40 to 1:30"; empty: unknown.
std::string LeftText(const wire::JobInfo& job);
// Those that are not over first; of each the latest first.
void SortForPeople(std::vector<wire::JobInfo>* jobs);
// What whoever looks on may do about it; empty: nothing is to be done.
std::string AdviceOf(const wire::JobInfo& job, std::size_t workers);
// pause, resume, cancel, retry, delete, priority: what a job of its state obeys.
std::vector<std::string> ActionsFor(const wire::JobInfo& job);

}  // namespace cairn::page
