// What starts workers: this machine, some hosts, a cluster. It places and restarts nothing by itself: which
// are to run is Scaler's (scaler.h).
#pragma once

#include <string>
#include <vector>

#include "schema/error.h"

namespace cairn::coordinator {

struct EngineWorker {
  enum class State {
    kWaiting,  // for its place
    kRuns,
    kEnded,  // and is not forgotten yet
  };
  std::string name = {};
  State state = State::kRuns;
  std::string where = {};  // the host, where it is known
  std::string why = {};    // it waits, or has ended, for people; empty: as it was told to
};

class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  // All that it has of ours, whoever started them: a Scaler may have ended and another have begun.
  virtual Result<std::vector<EngineWorker>> List() = 0;

  struct Started {
    std::vector<std::string> names;  // those that were begun
    Status status;                   // why not all were
  };
  // Begins workers of these names, as many as it can.
  virtual Started Start(const std::vector<std::string>& names) = 0;
  // Ends those that wait for their place or say nothing.
  virtual Status Stop(const std::vector<std::string>& names) = 0;
  // They have ended: what is left of them may go.
  virtual void Forget(const std::vector<std::string>& names) = 0;
};

}  // namespace cairn::coordinator
