#include "tests/simulation/world.h"

#include <algorithm>

namespace cairn::simulation {
namespace {

constexpr double kPatience_s = 2000;  // after everything healed
constexpr std::uint64_t kMostEvents = 2'000'000;

}  // namespace

World::World(std::uint64_t seed, Trace trace)
    : faults(DrawFaults(seed)),
      rng(seed, 2),
      trace_(std::move(trace)),
      shell_(std::make_unique<ShellModel>(*this)) {}

Outcome World::Run() {
  SubmitJobs();
  for (int i = 0; i < faults.workers; ++i) AddWorker(false);
  shell_->Start();
  EverySecond();
  while (checks.violation().empty() && !(healed_ && AllEnded())) {
    if (!schedule.Step() || ++outcome.events > kMostEvents ||
        schedule.now_s() > faults.trouble_s + kPatience_s) {
      checks.Fail("not every job ended: " + shell_->Summary());
      break;
    }
  }
  if (checks.violation().empty()) shell_->CheckEnd(jobs_);
  outcome.violation = checks.violation();
  outcome.simulated_s = schedule.now_s();
  return outcome;
}

bool World::AllEnded() const { return shell_->AllEnded(jobs_); }

void World::SubmitJobs() {
  for (int i = 0; i < faults.jobs + (faults.bad_input ? 1 : 0); ++i) {
    const std::string id = "job" + std::to_string(i);
    const proto::Job job =
        MakeToyJob(rng.Bits64() >> 8, faults.stages, faults.rounds, faults.tasks, i >= faults.jobs);
    jobs_.push_back(id);
    schedule.After(rng.Uniform(0, i == 0 ? 0.1 : 10), [this, id, job] { shell_->Submit(id, job); });
  }
}

void World::AddWorker(bool may_be_other_build) {
  const std::string name = "w" + std::to_string(next_worker_++);
  const bool other = may_be_other_build && Chance(faults.other_build);
  const double speed = Chance(faults.slow) ? 0.05 : 1.0;
  workers_[name] = std::make_unique<WorkerModel>(*this, name, other ? "other" : "1", speed,
                                                 static_cast<std::uint32_t>(1 + rng.Below(4)));
  workers_[name]->Start();
}

std::vector<double> World::Deliveries(const std::string& peer) {
  const auto cut = cut_until_s_.find(peer);
  if ((cut != cut_until_s_.end() && schedule.now_s() < cut->second) || Chance(faults.lose)) {
    ++outcome.messages_lost;
    return {};
  }
  std::vector<double> delays;
  const int copies = Chance(faults.duplicate) ? 2 : 1;
  for (int i = 0; i < copies; ++i)
    delays.push_back(Chance(faults.late) ? rng.Uniform(0, 15) : rng.Uniform(0.0001, faults.delay_s));
  return delays;
}

void World::ToCoordinator(const std::string& peer, coordinator::Event event) {
  for (const double delay : Deliveries(peer))
    schedule.After(delay, [this, event] { shell_->Deliver(event); });
}

void World::ToWorker(const std::string& peer, wire::Envelope message) {
  for (const double delay : Deliveries(peer))
    schedule.After(delay, [this, peer, message] {
      const auto it = workers_.find(peer);
      if (it != workers_.end()) it->second->Receive(message);
    });
}

void World::EverySecond() {
  if (!healed_ && schedule.now_s() >= faults.trouble_s) Heal();
  if (!healed_) {
    DisturbWorkers();
    DisturbUsers();
    if (Chance(faults.coordinator_crash_per_s)) shell_->Crash(rng.Uniform(0.1, 8));
  } else {
    for (const std::string& id : jobs_) shell_->ResumeIfStopped(id);
  }
  schedule.After(1, [this] { EverySecond(); });
}

void World::DisturbWorkers() {
  int alive = 0;
  for (auto& [name, worker] : workers_) {
    if (Chance(faults.partition_per_s)) {
      cut_until_s_[name] = schedule.now_s() + rng.Uniform(0.5, 15);
      Say(name + " is cut off until " + std::to_string(cut_until_s_[name]));
    }
    if (worker->alive() && Chance(faults.crash_per_s)) worker->Crash();
    if (worker->alive() && Chance(faults.leave_per_s)) worker->Leave();
    if (worker->alive() && Chance(faults.hang_per_s)) worker->Hang();
    if (worker->alive()) ++alive;
  }
  if ((alive < faults.workers && rng.Below(3) == 0) || Chance(faults.late_joiners_per_s)) AddWorker(true);
}

void World::DisturbUsers() {
  for (const std::string& id : jobs_) {
    if (Chance(faults.cancel_per_s)) shell_->Deliver(coordinator::CancelJob{id});
    if (rng.Below(4) == 0) shell_->ResumeIfStopped(id);
  }
  if (rng.Below(10) == 0) shell_->Deliver(coordinator::SaveNow{});
}

void World::Heal() {
  Say("everything heals");
  healed_ = true;
  cut_until_s_.clear();
  AddWorker(false);
  AddWorker(false);
}

}  // namespace cairn::simulation
