#include "tests/simulation/scale_world.h"

#include <algorithm>
#include <cmath>

namespace cairn::simulation {
namespace {

using coordinator::EngineWorker;

constexpr double kDay_s = 86400, kTurn_s = 5;
// An engine takes so long at most, where it is well.
constexpr double kPlace_s = 60;
// After the last trouble it may take so long until all is as it should be: an engine that refused is asked
// again, those that never said Hello are given up, and their successors come.
constexpr double kSettle_s = 1500;

}  // namespace

ScaleWorld::ScaleWorld(std::uint64_t seed, Trace trace) : rng_(seed, 0x5ca1e), trace_(std::move(trace)) {
  options_.prefix = "w-";
  options_.policy.least = static_cast<int>(rng_.Below(3));
  options_.policy.most = options_.policy.least + 1 + static_cast<int>(rng_.Below(20));
  options_.policy.work_s = rng_.Uniform(5, 60);
  options_.policy.idle_s = rng_.Uniform(10, 300);
  options_.policy.cool_down_s = rng_.Uniform(0, 120);
  NewScaler();
}

// One goes on where another ended; but how long a worker has been idle it counts anew.
void ScaleWorld::NewScaler() {
  idle_since_s_ = busy_since_s_ = -1;
  for (Process& process : processes_) process.idle_since_s = -1;
  coordinator::Engine& engine = *this;
  coordinator::ScaledService& service = *this;
  coordinator::WorkerKeys& keys = *this;
  scaler_ = std::make_unique<coordinator::Scaler>(
      options_, engine, service, keys,
      [this](coordinator::Severity, const std::string& line) { Note(line); });
}

void ScaleWorld::Fail(const std::string& what) {
  if (outcome_.violation.empty()) outcome_.violation = "at " + std::to_string(now_s_) + " s: " + what;
}

ScaleOutcome ScaleWorld::Run(double days) {
  while (now_s_ < days * kDay_s && outcome_.violation.empty()) {
    Pass(kTurn_s);
    if (Chance(1.0 / 2000)) NewScaler();
    scaler_->Turn(now_s_);
    ++outcome_.turns;
    Check();
  }
  return outcome_;
}

void ScaleWorld::Pass(double seconds) {
  now_s_ += seconds;
  BeginAndEndTroubles();
  ComeAndGo();
  Connect();
  Work(seconds);
  LoseSome();
}

void ScaleWorld::BeginAndEndTroubles() {
  for (double& until_s : until_s_)
    if (until_s <= now_s_ && Chance(kTurn_s / (0.3 * kDay_s))) {
      until_s = now_s_ + rng_.Uniform(10, 2000);
      ++outcome_.troubles;
    }
  for (const double until_s : until_s_)
    if (until_s > now_s_) calm_since_s_ = now_s_;
}

// Jobs of all sizes, in swarms, with nights between them.
void ScaleWorld::ComeAndGo() {
  const bool night = std::fmod(now_s_, kDay_s) < 0.3 * kDay_s;
  if (!night && Chance(kTurn_s / 3600)) {
    const std::uint64_t swarm = Chance(0.2) ? 1 + rng_.Below(30) : 1;
    for (std::uint64_t i = 0; i < swarm; ++i)
      jobs_.push_back({1 + static_cast<int>(rng_.Below(40)), std::pow(10.0, rng_.Uniform(0, 4.5))});
    changed_s_ = now_s_;
    Note(std::to_string(swarm) + " jobs come");
  }
  std::erase_if(jobs_, [](const Job& job) { return job.work_s <= 0; });
}

void ScaleWorld::Connect() {
  for (Process& process : processes_) {
    const bool may = now_s_ >= process.connects_s && !process.mute && keys_.contains(process.name);
    if (process.connected || !may) continue;
    process.connected = true;
    process.number = next_number_++;
    process.assigned = 0;
  }
}

void ScaleWorld::Work(double seconds) {
  for (Process& process : processes_) process.assigned = 0;
  auto process = processes_.begin();
  for (Job& job : jobs_)
    for (int task = 0; task < job.tasks && job.work_s > 0; ++task) {
      process = std::find_if(process, processes_.end(),
                             [](const Process& one) { return one.connected && !one.draining; });
      if (process == processes_.end()) break;
      process->assigned = 1;
      job.work_s -= seconds;
      ++process;
    }
  for (std::size_t i = 0; i < processes_.size();)
    if (processes_[i].connected && processes_[i].draining && processes_[i].assigned == 0)
      End(i, "");
    else
      ++i;
}

void ScaleWorld::End(std::size_t process, const std::string& why) {
  const std::string name = processes_[process].name;
  processes_.erase(processes_.begin() + static_cast<std::ptrdiff_t>(process));
  if (std::ranges::none_of(processes_, [&](const Process& other) { return other.name == name; }))
    ended_[name] = why;
}

// A node with all that is on it, a connection, or one that the engine does not notice.
void ScaleWorld::LoseSome() {
  if (processes_.empty() || !Chance(kTurn_s / 5000)) return;
  calm_since_s_ = changed_s_ = now_s_;
  const std::uint64_t how = rng_.Below(4);
  const std::uint64_t count = 1 + rng_.Below(std::min<std::uint64_t>(processes_.size(), 4));
  for (std::uint64_t i = 0; i < count && !processes_.empty(); ++i) {
    const std::size_t which = rng_.Below(processes_.size());
    Process& process = processes_[which];
    const bool alone = std::ranges::count(processes_, process.name, &Process::name) == 1;
    ++outcome_.lost;
    if (how == 3 && process.connected) {
      Note("trouble: the engine takes " + process.name + " for ended");
      ended_[process.name] = "the engine says so";
    } else if (how == 0 || !alone) {  // of two of one name the one that hangs cannot be told
      Note("trouble: " + process.name + " is lost");
      End(which, "its node is down");
    } else {
      Note("trouble: " + process.name + (how == 1 ? " is cut off" : " hangs"));
      process.connected = false;
      process.mute = how == 2;
      process.connects_s = now_s_ + rng_.Uniform(1, 60);
    }
  }
}

std::size_t ScaleWorld::Connected() const {
  return static_cast<std::size_t>(std::ranges::count(processes_, true, &Process::connected));
}

void ScaleWorld::Check() {
  const auto most = static_cast<std::size_t>(options_.policy.most),
             least = static_cast<std::size_t>(options_.policy.least);
  const bool calm = now_s_ - calm_since_s_ > kSettle_s;
  const int wanted = [&] {
    std::vector<wire::Demand> demand;
    for (const Job& job : jobs_) {
      demand.emplace_back().set_tasks(static_cast<std::uint32_t>(job.tasks));
      demand.back().set_work_s(job.work_s);
    }
    return coordinator::WorkersWanted(options_.policy, demand);
  }();
  if (wanted < options_.policy.most)
    busy_since_s_ = -1;
  else if (busy_since_s_ < 0)
    busy_since_s_ = now_s_;
  if (!jobs_.empty())
    idle_since_s_ = -1;
  else if (idle_since_s_ < 0)
    idle_since_s_ = now_s_;

  if (calm && processes_.size() > most)
    Fail(std::to_string(processes_.size()) + " workers, allowed are " + std::to_string(most));
  if (calm && busy_since_s_ >= 0 && now_s_ - busy_since_s_ > 2 * kPlace_s + 10) {
    if (Connected() != most)
      Fail("as many as are allowed are wanted, and " + std::to_string(Connected()) + " are there");
    ++outcome_.most_reached;
  }
  const double leaves_s = options_.policy.idle_s + options_.policy.cool_down_s + 2 * kPlace_s + 10;
  if (calm && idle_since_s_ >= 0 && now_s_ - idle_since_s_ > leaves_s) {
    if (processes_.size() != least)
      Fail("there is no job, and " + std::to_string(processes_.size()) + " workers are there");
    std::set<std::string> names;
    for (const Process& process : processes_) names.insert(process.name);
    if (keys_ != names)
      Fail(std::to_string(keys_.size()) + " keys of " + std::to_string(names.size()) + " workers");
    ++outcome_.least_reached;
  }
}

Result<std::vector<EngineWorker>> ScaleWorld::List() {
  if (Troubled(kAway)) return Status(Code::kIo, "the engine is away");
  std::vector<EngineWorker> list;
  for (const Process& process : processes_) {
    if (ended_.contains(process.name) || (Troubled(kForgetful) && Chance(0.2))) continue;
    list.push_back(
        {.name = process.name,
         .state = now_s_ < process.runs_s ? EngineWorker::State::kWaiting : EngineWorker::State::kRuns});
  }
  for (const auto& [name, why] : ended_)
    list.push_back({.name = name, .state = EngineWorker::State::kEnded, .why = why});
  return list;
}

coordinator::Engine::Started ScaleWorld::Start(const std::vector<std::string>& names) {
  if (changed_s_ < drained_s_ && now_s_ - calm_since_s_ > kSettle_s && jobs_.empty() == false)
    Fail("starts workers that it let go before, though nothing has come since");
  Started started;
  for (const std::string& name : names) {
    if (!keys_.contains(name)) Fail(name + " is started without a key");
    if (Troubled(kRefuses) && Chance(0.9)) {
      started.status = {Code::kRefused, "the engine refuses"};
      continue;
    }
    const int copies = !Troubled(kRefuses) && Troubled(kLate) && Chance(0.1) ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      Process process;
      process.name = name;
      process.runs_s = now_s_ + (Troubled(kLate) ? rng_.Uniform(0, 1000) : rng_.Uniform(0, kPlace_s / 2));
      process.connects_s = process.runs_s + rng_.Uniform(0, kPlace_s / 2);
      process.mute = copies == 1 && Troubled(kLate) && Chance(0.1);
      processes_.push_back(process);
    }
    ++outcome_.started;
    started.names.push_back(name);
  }
  return started;
}

Status ScaleWorld::Stop(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (told_connected_.contains(name)) Fail(name + " is connected, and is stopped");
    for (std::size_t i = 0; i < processes_.size();)
      if (processes_[i].name == name && !Chance(Troubled(kForgetful) ? 0.5 : 0))
        End(i, "");
      else
        ++i;
  }
  return Status::Ok();
}

void ScaleWorld::Forget(const std::vector<std::string>& names) {
  for (const std::string& name : names) ended_.erase(name);
}

Result<coordinator::ScaleFacts> ScaleWorld::Ask() {
  told_connected_.clear();
  told_idle_.clear();
  if (Troubled(kServiceAway)) return Status(Code::kIo, "the coordinator is away");
  coordinator::ScaleFacts facts;
  for (const Job& job : jobs_) {
    wire::Demand& demand = facts.demand.emplace_back();
    demand.set_tasks(static_cast<std::uint32_t>(job.tasks));
    demand.set_work_s(job.work_s);
  }
  for (Process& process : processes_) {
    if (!process.connected) continue;
    if (process.assigned > 0)
      process.idle_since_s = -1;
    else if (process.idle_since_s < 0)
      process.idle_since_s = now_s_;
    wire::WorkerInfo& info = facts.workers.emplace_back();
    info.set_name(process.name);
    info.set_number(process.number);
    info.set_assigned(static_cast<std::uint32_t>(process.assigned));
    info.set_state(process.draining ? "draining" : process.assigned > 0 ? "busy" : "idle");
    told_connected_.insert(process.name);
    if (process.assigned == 0) told_idle_.insert(process.number);
  }
  return facts;
}

Status ScaleWorld::Drain(std::uint64_t worker) {
  const bool too_many = Connected() > static_cast<std::size_t>(options_.policy.most);
  if (!told_idle_.contains(worker) && !too_many) Fail("a worker that computes is let go");
  for (Process& process : processes_) {
    if (!process.connected || process.number != worker) continue;
    process.draining = true;
    if (!too_many && now_s_ - process.idle_since_s < options_.policy.idle_s)
      Fail(process.name + " is let go as soon as it has nothing to do");
  }
  ++outcome_.drained;
  drained_s_ = now_s_;
  return Status::Ok();
}

Result<std::vector<std::string>> ScaleWorld::Names() {
  return std::vector<std::string>(keys_.begin(), keys_.end());
}

Status ScaleWorld::Make(const std::string& name) {
  if (!keys_.insert(name).second) Fail(name + " had a key already");
  return Status::Ok();
}

// Whoever has it is refused, and ends.
Status ScaleWorld::Revoke(const std::string& name) {
  keys_.erase(name);
  if (told_connected_.contains(name)) Fail(name + " is connected, and its key is revoked");
  for (std::size_t i = 0; i < processes_.size();)
    if (processes_[i].name == name && now_s_ >= processes_[i].runs_s && !processes_[i].mute)
      End(i, "refused");
    else
      ++i;
  return Status::Ok();
}

}  // namespace cairn::simulation
