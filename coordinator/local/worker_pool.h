// Worker processes of one's own: started, started again when they die, and gone when this process is.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "schema/error.h"

namespace cairn::coordinator {

struct WorkerPoolOptions {
  std::string program;   // path of cairn-worker
  std::string endpoint;  // to connect to
  int workers = 1;
  int restarts = 5;                  // of each
  std::filesystem::path log_file;    // what they say goes here
  std::uint64_t task_memory_mb = 0;  // their own limit on a task; 0: none
  int inputs_fd = -1;  // memory that they share with this process (schema/wire/shared_blobs.h); -1: none
};

class WorkerPool {
 public:
  explicit WorkerPool(WorkerPoolOptions options) : options_(std::move(options)) {}
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // kNotFound, kIo: they cannot be started. kRefused: in the place of that file is something else. The file
  // for what they say is opened once: it stays the one that it is, whatever becomes of its name.
  Status Start();
  struct Death {
    std::int64_t pid = 0;
    bool refused = false;      // it says that it was, or that it cannot connect
    int signal = 0;            // that ended it; 0: none did
    bool killed_here = false;  // by Kill()
  };
  // Those that have died since the last call; they were started again while their turns last.
  std::vector<Death> Reap();
  // Nothing where it is none of these any more.
  void Kill(std::int64_t pid);
  bool AllGone() const;  // and none is started again
  // Waits for them to end by themselves for up to `patience_s`, then kills.
  void End(double patience_s);

 private:
  struct Place {
    pid_t pid = 0;  // 0: nobody
    int restarts = 0;
    bool killed_here = false;
  };
  Status OpenLog();
  Result<pid_t> Spawn() const;

  const WorkerPoolOptions options_;
  int log_ = -1;  // file descriptor
  std::vector<Place> places_;
};

}  // namespace cairn::coordinator
