// One simulated world: the coordinator's core, workers, a network, a disk and users, under the faults that
// its seed draws. The same seed gives the same world, event for event.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "schema/rng.h"
#include "tests/simulation/checks.h"
#include "tests/simulation/faults.h"
#include "tests/simulation/schedule.h"
#include "tests/simulation/shell_model.h"
#include "tests/simulation/worker_model.h"

namespace cairn::simulation {

using Trace = std::function<void(double now_s, const std::string& line)>;

struct Outcome {
  std::string violation;  // empty: all is well
  std::uint64_t events = 0;
  double simulated_s = 0;
  // What happened, so that a test can tell that something did.
  std::uint64_t coordinator_crashes = 0, worker_ends = 0, messages_lost = 0, failed_saves = 0, damaged = 0;
};

class World {
 public:
  World(std::uint64_t seed, Trace trace);
  Outcome Run();

  // ---- for the models ----
  Schedule schedule;
  const Faults faults;
  Rng rng;
  Outcome outcome;
  Checks checks;

  bool Chance(double probability) { return !healed_ && probability > 0 && rng.Uniform() < probability; }
  bool healed() const { return healed_; }
  void Say(const std::string& line) const {
    if (trace_) trace_(schedule.now_s(), line);
  }
  bool tracing() const { return static_cast<bool>(trace_); }
  void ToCoordinator(const std::string& peer, coordinator::Event event);
  void ToWorker(const std::string& peer, wire::Envelope message);
  ShellModel& shell() { return *shell_; }

 private:
  // What happens to one message: each delay is one delivery, none is a loss.
  std::vector<double> Deliveries(const std::string& peer);
  void AddWorker(bool may_be_other_build);
  void SubmitJobs();
  void EverySecond();
  void DisturbWorkers();
  void DisturbUsers();
  void Heal();
  bool AllEnded() const;

  const Trace trace_;
  bool healed_ = false;
  int next_worker_ = 0;
  std::map<std::string, std::unique_ptr<WorkerModel>> workers_;
  std::map<std::string, double> cut_until_s_;  // partitions, by peer
  std::unique_ptr<ShellModel> shell_;
  std::vector<std::string> jobs_;
};

}  // namespace cairn::simulation
