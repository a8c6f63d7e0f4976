// One simulated world: the coordinator's core, its process and store, workers, a network and users, under the
// faults that its seed draws. The same seed gives the same world, event for event.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "schema/rng.h"
#include "tests/simulation/checks.h"
#include "tests/simulation/coverage.h"
#include "tests/simulation/faults.h"
#include "tests/simulation/network_model.h"
#include "tests/simulation/schedule.h"
#include "tests/simulation/shell_model.h"
#include "tests/simulation/uploader_model.h"
#include "tests/simulation/users.h"
#include "tests/simulation/worker_model.h"

namespace cairn::simulation {

using Trace = std::function<void(double now_s, const std::string& line)>;

struct Outcome {
  std::string violation;  // empty: all is well
  std::uint64_t events = 0;
  double simulated_s = 0;
  Coverage coverage{};
};

class World {
 public:
  World(std::uint64_t seed, Trace trace);
  Outcome Run();

  // ---- for the models ----
  Schedule schedule;
  const Faults faults;
  Rng rng;
  Checks checks;
  NetworkModel network;
  Users users;
  UploaderModel uploaders;

  bool Chance(double probability) { return !healed_ && probability > 0 && rng.Uniform() < probability; }
  bool healed() const { return healed_; }
  void Count(Mark mark) { ++outcome_.coverage[mark]; }
  void Say(const std::string& line) const {
    if (trace_) trace_(schedule.now_s(), line);
  }
  bool tracing() const { return static_cast<bool>(trace_); }
  ShellModel& shell() { return *shell_; }
  WorkerModel* FindWorker(const std::string& name);  // null where there is none

 private:
  void AddWorker(bool is_late);
  void EverySecond();
  void DisturbWorkers();
  void DisturbCoordinator();
  void Heal();

  const Trace trace_;
  Outcome outcome_;
  bool healed_ = false;
  int next_worker_ = 0;
  std::map<std::string, std::unique_ptr<WorkerModel>> workers_;
  std::unique_ptr<ShellModel> shell_;
};

}  // namespace cairn::simulation
