// `cairn coordinator --on-end PROGRAM`: what the operator of a service has run whenever a job has ended, with
// the job on its standard input, as `cairn status JOB --json` prints it. Submitters choose nothing of it:
// what is theirs, a job's name say, is in the input alone.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

#include "coordinator/store/log.h"
#include "schema/wire.pb.h"

namespace cairn::cli {

// One after the other, by a thread of its own: who tells it of a job waits for nothing.
class EndHook {
 public:
  static constexpr std::size_t kMostWaiting = 1000;

  // `program` is looked for in PATH where it is no path. One that runs for longer than `limit_s` is killed,
  // with all that it started, a second later also where this process is killed; what it leaves running when
  // it ends is killed then. `log` is called by that thread.
  EndHook(std::string program, double limit_s, coordinator::LogSink log);
  // Kills what runs. How many were not run the log says.
  ~EndHook();
  EndHook(const EndHook&) = delete;
  EndHook& operator=(const EndHook&) = delete;

  void JobEnded(const wire::JobInfo& job);
  // None runs, and none waits.
  bool Idle();

 private:
  void Loop();
  void Run(const wire::JobInfo& job);

  const std::string program_;
  const double limit_s_;
  const coordinator::LogSink log_;
  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<wire::JobInfo> waiting_;
  bool runs_ = false;
  std::size_t dropped_ = 0;  // that found no room, and are not told yet
  std::atomic<bool> stop_{false};
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace cairn::cli
