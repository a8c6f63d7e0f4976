// A demand (error.h) that fails within a task: the task is over, and not the process, which has tasks of
// other jobs in hand. What a task was handed others have made, who may lie.
#pragma once

namespace cairn {

// While one lives, a demand of this thread that does not hold throws std::logic_error with its text.
class DemandsThrow {
 public:
  DemandsThrow();
  ~DemandsThrow();
  DemandsThrow(const DemandsThrow&) = delete;
  DemandsThrow& operator=(const DemandsThrow&) = delete;

 private:
  bool before_;
};

}  // namespace cairn
