// Pipelines with tasks that take long enough to be caught in the middle of one.
//
//   CAIRN_TASK_MS    each RUN task takes this many milliseconds longer
//   CAIRN_HANG_FILE  the one worker that can remove this file hangs in the task at hand, without a tick, for
//   ever
//   CAIRN_TRACE_FILE a line for each RUN task as it begins: monotonic milliseconds, process, task
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "pipelines/pipeline.h"

namespace cairn::faults {

class Slowed : public Pipeline {
 public:
  explicit Slowed(std::unique_ptr<const Pipeline> inner) : inner_(std::move(inner)) {
    if (const char* ms = std::getenv("CAIRN_TASK_MS")) task_ms_ = std::atoi(ms);
    if (const char* file = std::getenv("CAIRN_HANG_FILE")) hang_file_ = file;
    if (const char* file = std::getenv("CAIRN_TRACE_FILE")) trace_file_ = file;
  }
  Step Start(const Inputs& inputs) const override { return inner_->Start(inputs); }
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override {
    if (!trace_file_.empty()) Trace(task);
    if (!hang_file_.empty() && ::unlink(hang_file_.c_str()) == 0)
      while (true) std::this_thread::sleep_for(std::chrono::hours(1));
    for (int i = 0; i < task_ms_; ++i) {
      progress.Tick();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return inner_->Run(task, inputs, progress);
  }
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override {
    return inner_->Advance(state, partials, inputs);
  }

 private:
  // One write, so that lines of several processes do not mix.
  void Trace(const Task& task) const {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const std::string line =
        std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(now).count()) + " " +
        std::to_string(::getpid()) + " " + task.ShortDebugString() + "\n";
    const int fd = ::open(trace_file_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (::write(fd, line.data(), line.size()) < 0) std::abort();
    ::close(fd);
  }

  const std::unique_ptr<const Pipeline> inner_;
  int task_ms_ = 0;
  std::string hang_file_, trace_file_;
};

}  // namespace cairn::faults
