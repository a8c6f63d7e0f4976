// The page of a run, in a process of its own (cairn-page).
#pragma once

#include <sys/types.h>

#include <string>

namespace cairn::cli {

// It prints its link on stderr, so that stdout holds facts alone, and ends with this process.
class RunPage {
 public:
  // `endpoint`: of the run's coordinator; `dir`: where its results will be.
  // Throws WorldError where it cannot be started.
  RunPage(const std::string& endpoint, const std::string& dir);
  // Tells whoever looks on that the run is over, and ends it.
  ~RunPage();
  RunPage(const RunPage&) = delete;
  RunPage& operator=(const RunPage&) = delete;

 private:
  pid_t pid_;
};

}  // namespace cairn::cli
