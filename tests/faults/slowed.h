// Pipelines with tasks that take long enough to be caught in the middle of one.
//
//   CAIRN_TASK_MS    each RUN task takes this many milliseconds longer
//   CAIRN_HANG_FILE  the one worker that can remove this file hangs in the task at hand, without a tick, for
//   ever
#pragma once

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
  }
  Step Start(const Inputs& inputs) const override { return inner_->Start(inputs); }
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override {
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
  const std::unique_ptr<const Pipeline> inner_;
  int task_ms_ = 0;
  std::string hang_file_;
};

}  // namespace cairn::faults
