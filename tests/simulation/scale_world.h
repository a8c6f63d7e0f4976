// A service whose jobs come and go, an engine that refuses, starts late or twice, loses workers and lies, and
// the real Scaler between them: days of it, from a seed. What must hold is checked at each turn.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/scale/scaler.h"
#include "schema/rng.h"

namespace cairn::simulation {

using Trace = std::function<void(double now_s, const std::string& line)>;

struct ScaleOutcome {
  std::string violation;  // empty: none
  std::uint64_t turns = 0, started = 0, drained = 0, lost = 0, troubles = 0;
  std::uint64_t most_reached = 0, least_reached = 0;  // how often it was seen to be so, as it must
};

class ScaleWorld : coordinator::Engine, coordinator::ScaledService, coordinator::WorkerKeys {
 public:
  ScaleWorld(std::uint64_t seed, Trace trace);
  ScaleOutcome Run(double days);

 private:
  struct Job {
    int tasks = 1;
    double work_s = 0;
  };
  // A process, or the place that waits for one.
  struct Process {
    std::string name;
    double runs_s = 0, connects_s = 0;  // from when on
    bool mute = false;                  // it never says Hello
    bool connected = false, draining = false;
    std::uint64_t number = 0;
    int assigned = 0;
    double idle_since_s = -1;  // as it was told; -1: it computes
  };
  enum Trouble { kRefuses, kAway, kServiceAway, kForgetful, kLate, kTroubles };

  Result<std::vector<coordinator::EngineWorker>> List() override;
  Started Start(const std::vector<std::string>& names) override;
  Status Stop(const std::vector<std::string>& names) override;
  void Forget(const std::vector<std::string>& names) override;
  Result<coordinator::ScaleFacts> Ask() override;
  Status Drain(std::uint64_t worker) override;
  Result<std::vector<std::string>> Names() override;
  Status Make(const std::string& name) override;
  Status Revoke(const std::string& name) override;

  void Pass(double seconds);
  void BeginAndEndTroubles();
  void ComeAndGo();
  void Connect();
  void Work(double seconds);
  void LoseSome();
  void End(std::size_t process, const std::string& why);
  void Check();
  void NewScaler();
  void Note(const std::string& line) const {
    if (trace_) trace_(now_s_, line);
  }
  void Fail(const std::string& what);
  bool Chance(double probability) { return rng_.Uniform() < probability; }
  bool Troubled(Trouble trouble) const { return until_s_[trouble] > now_s_; }
  std::size_t Connected() const;

  Rng rng_;
  const Trace trace_;
  coordinator::ScalerOptions options_;
  std::unique_ptr<coordinator::Scaler> scaler_;
  ScaleOutcome outcome_;
  double now_s_ = 0;
  double calm_since_s_ = 0;   // no trouble, no loss
  double busy_since_s_ = -1;  // as many as are allowed are wanted; -1: they are not
  double idle_since_s_ = 0;   // there is no job; -1: there is
  double changed_s_ = 0;      // a job came, or a worker went that was not told to
  double drained_s_ = -1e18;  // the last time one was
  double until_s_[kTroubles] = {};
  std::vector<Job> jobs_;
  std::vector<Process> processes_;
  std::map<std::string, std::string> ended_;  // why, by name
  std::set<std::string> keys_;
  std::set<std::uint64_t> told_idle_;  // by the last answer
  std::set<std::string> told_connected_;
  std::uint64_t next_number_ = 1;
};

}  // namespace cairn::simulation
