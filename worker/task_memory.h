// Holds the thread that computes to a limit on what a task allocates: malloc and all that rests on it (new,
// Eigen, OpenCV) fail there beyond the limit, as they would without memory; other threads notice nothing.
// Counted is what the thread has allocated and not freed since the task began; inputs come from elsewhere.
// Builds with sanitizers, which have an allocator of their own, hold nothing to a limit.
#pragma once

#include <cstdint>
#include <string>

namespace cairn::worker {

class TaskMemory {
 public:
  // 0: no limit, each. `worker_mb`: whatever a job says.
  TaskMemory(std::uint64_t job_mb, std::uint64_t worker_mb);
  // "" as long as nothing was refused, which a pipeline may have taken for anything; else why, for people.
  std::string WhyRefused() const;

  // While it lives, this thread is held to the limit …
  class Hold {
   public:
    explicit Hold(TaskMemory& memory);
    ~Hold();
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    TaskMemory& memory_;
  };
  // … but for what happens while one of these does, which is not the task's own.
  class Pause {
   public:
    Pause();
    ~Pause();
    Pause(const Pause&) = delete;
    Pause& operator=(const Pause&) = delete;

   private:
    bool held_;
  };

 private:
  std::uint64_t limit_mb_;
  bool by_job_;
  bool refused_ = false;
};

}  // namespace cairn::worker
