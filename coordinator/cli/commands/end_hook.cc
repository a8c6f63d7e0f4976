#include "coordinator/cli/commands/end_hook.h"

#include <cmath>
#include <utility>
#include <vector>

#include "coordinator/cli/output/job_text.h"
#include "coordinator/scale/engines/programs.h"

namespace cairn::cli {

using coordinator::Severity;

EndHook::EndHook(std::string program, double limit_s, coordinator::LogSink log)
    : program_(std::move(program)), limit_s_(limit_s), log_(std::move(log)), thread_([this] { Loop(); }) {}

EndHook::~EndHook() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_one();
  thread_.join();
  if (!waiting_.empty())
    log_(Severity::kWarning, "--on-end: " + program_ + " was not run for " + std::to_string(waiting_.size()) +
                                 " of the jobs that have ended, as the service ends");
}

void EndHook::JobEnded(const wire::JobInfo& job) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMostWaiting)
      waiting_.push_back(job);
    else
      ++dropped_;
  }
  changed_.notify_one();
}

bool EndHook::Idle() {
  const std::lock_guard lock(mutex_);
  return !runs_ && waiting_.empty();
}

void EndHook::Loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
    if (stop_) return;
    const wire::JobInfo job = std::move(waiting_.front());
    waiting_.pop_front();
    const std::size_t dropped = std::exchange(dropped_, 0);
    runs_ = true;
    lock.unlock();
    if (dropped > 0)
      log_(Severity::kWarning, "--on-end: " + program_ + " is too slow: it is not run for " +
                                   std::to_string(dropped) + " jobs that have ended");
    Run(job);
    lock.lock();
    runs_ = false;
  }
}

// The limit is kept here; `timeout` keeps it, a little later, where this process is killed meanwhile.
void EndHook::Run(const wire::JobInfo& job) {
  const std::string at_most_s = std::to_string(std::lround(std::ceil(limit_s_)) + 1);
  const std::vector<coordinator::Program> programs = {
      {.words = {"timeout", "-s", "KILL", at_most_s, program_},
       .input = JobJson(job),
       .name = program_,
       .alone = true}};
  const std::string failure = coordinator::RunPrograms(programs, limit_s_, &stop_).at(0).failure;
  if (!failure.empty()) log_(Severity::kWarning, "--on-end for job " + job.id() + ": " + failure);
}

}  // namespace cairn::cli
