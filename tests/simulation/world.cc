#include "tests/simulation/world.h"

namespace cairn::simulation {
namespace {

constexpr double kPatience_s = 2000;  // after everything healed
constexpr std::uint64_t kMostEvents = 2'000'000;

}  // namespace

World::World(std::uint64_t seed, Trace trace)
    : faults(DrawFaults(seed)),
      rng(seed, 2),
      checks(*this),
      network(*this),
      users(*this),
      uploaders(*this),
      trace_(std::move(trace)),
      shell_(std::make_unique<ShellModel>(*this)) {}

Outcome World::Run() {
  users.Start();
  if (Chance(faults.other_build)) AddWorker(true);  // who comes first may be a stray, and decides nothing
  for (int i = 0; i < faults.workers; ++i) AddWorker(false);
  shell_->Start();
  EverySecond();
  while (checks.violation().empty() && !(healed_ && users.AllEnded())) {
    if (!schedule.Step() || ++outcome_.events > kMostEvents ||
        schedule.now_s() > faults.trouble_s + kPatience_s) {
      checks.Fail("not every job ended: " + users.Summary());
      break;
    }
  }
  if (checks.violation().empty()) users.CheckEnd();
  outcome_.violation = checks.violation();
  outcome_.simulated_s = schedule.now_s();
  return outcome_;
}

WorkerModel* World::FindWorker(const std::string& name) {
  const auto it = workers_.find(name);
  return it == workers_.end() ? nullptr : it->second.get();
}

void World::AddWorker(bool is_late) {
  const std::string name = "w" + std::to_string(next_worker_++);
  WorkerTraits traits;
  if (is_late) Count(kWorkerLateJoiner);
  if (is_late && Chance(faults.other_build)) traits.build = "other", Count(kWorkerOtherBuild);
  if (Chance(faults.slow)) traits.speed = 0.05, Count(kWorkerSlow);
  traits.slots = static_cast<std::uint32_t>(1 + rng.Below(4));
  traits.lies = Chance(faults.liars);
  if (traits.lies && rng.Below(4) == 0) traits.slots = 1u << 31;
  workers_[name] = std::make_unique<WorkerModel>(*this, name, traits);
  workers_[name]->Start();
}

void World::EverySecond() {
  if (!healed_ && schedule.now_s() >= faults.trouble_s) Heal();
  if (healed_) {
    users.BringToAnEnd();
  } else {
    DisturbWorkers();
    users.Disturb();
    DisturbCoordinator();
  }
  uploaders.CheckThatTheyMove();
  schedule.After(1, [this] { EverySecond(); });
}

void World::DisturbWorkers() {
  int alive = 0;
  for (auto& [name, worker] : workers_) {
    const double now_s = schedule.now_s();
    if (Chance(faults.partition_per_s)) network.CutOff(name, now_s + rng.Uniform(0.5, 15));
    if (worker->alive() && Chance(faults.crash_per_s)) {
      Count(kWorkerKilled);
      worker->Crash();
    }
    if (worker->alive() && Chance(faults.leave_per_s)) {
      Count(kWorkerLeft);
      worker->Leave();
    }
    if (worker->alive() && Chance(faults.drain_per_s)) {
      Count(kDrainedByUser);
      shell_->Deliver(coordinator::DrainWorker{name});
    }
    if (worker->alive() && Chance(faults.terminate_per_s)) worker->BeTerminated();
    if (!worker->alive()) continue;
    ++alive;
    if (Chance(faults.break_per_s)) worker->BreakConnection();
    if (!worker->alive()) continue;
    if (Chance(faults.hang_per_s)) worker->Hang();
    if (Chance(faults.stop_per_s)) worker->StopUntil(now_s + rng.Uniform(0.5, 12));
    if (!Chance(faults.clock_jump_per_s)) continue;
    const bool forward = rng.Below(2) == 0;
    Count(forward ? kWorkerClockForward : kWorkerClockBackward);
    worker->JumpClock(forward ? rng.Uniform(0.5, 60) : -rng.Uniform(0.5, 15));
  }
  if ((alive < faults.workers && rng.Below(3) == 0) || Chance(faults.late_joiners_per_s)) AddWorker(true);
}

void World::DisturbCoordinator() {
  const double now_s = schedule.now_s();
  // At some moment of this second, not at its beginning.
  if (Chance(faults.coordinator_crash_per_s)) {
    const bool power_cut = Chance(faults.power_cut);
    const double down_s = rng.Uniform(0.1, 8);
    schedule.After(rng.Uniform(), [this, power_cut, down_s] { shell_->Crash(power_cut, down_s); });
  }
  if (Chance(faults.coordinator_stop_per_s)) {
    Count(kCoordinatorStalled);
    Say("the coordinator is stopped");
    shell_->StopUntil(now_s + rng.Uniform(0.5, 12));
  }
  if (Chance(faults.coordinator_clock_jump_per_s)) {
    const bool forward = rng.Below(2) == 0;
    Say(forward ? "the coordinator's clock jumps forward" : "the coordinator's clock jumps backward");
    Count(forward ? kClockForward : kClockBackward);
    shell_->JumpClock(forward ? rng.Uniform(0.5, rng.Below(3) == 0 ? 5000 : 20) : -rng.Uniform(0.5, 15));
  }
  if (Chance(faults.disk_full_per_s)) {
    Say("the disk is full");
    shell_->FillDiskUntil(now_s + rng.Uniform(0.5, 10));
  }
}

void World::Heal() {
  Say("everything heals");
  healed_ = true;
  network.Heal();
  shell_->FillDiskUntil(0);
  AddWorker(false);
  AddWorker(false);
}

}  // namespace cairn::simulation
