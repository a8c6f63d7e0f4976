#include "tests/simulation/worker_model.h"

#include <algorithm>

#include "coordinator/core/fleet.h"
#include "schema/blob_part.h"
#include "tests/simulation/world.h"

namespace cairn::simulation {

using coordinator::SameAttempt;

namespace {

Hash NameOf(const std::string& blob, const proto::BlobPart* part) {
  const Hash hash = Hash::FromBinary(blob).value();
  return part == nullptr ? hash : NameOfPart(hash, *part);
}

// All that the task reads, by what the answers will name.
std::map<Hash, wire::Fetch> FetchesOf(const wire::Assign& assign) {
  std::map<Hash, wire::Fetch> fetches;
  for (const proto::InputRef& input : assign.task().inputs()) {
    wire::Fetch& fetch = fetches[NameOf(input.blob(), input.has_part() ? &input.part() : nullptr)];
    fetch.set_hash(input.blob());
    if (input.has_part()) *fetch.mutable_part() = input.part();
  }
  if (assign.key().kind() == wire::TaskKey::RUN) return fetches;
  for (const Hash& hash : InputsOf(assign)) fetches[hash].set_hash(hash.Binary());
  return fetches;
}

}  // namespace

WorkerModel::WorkerModel(World& world, std::string name, WorkerTraits traits)
    : world_(world), name_(std::move(name)), traits_(std::move(traits)) {}

void WorkerModel::Start() {
  world_.Say(name_ + " starts" + (Foreign() ? ", another build" : "") + (traits_.speed < 1 ? ", slow" : "") +
             (traits_.lies ? ", a liar" : ""));
  KeepSayingHello();
  KeepHeartbeat();
  KeepFetching();
}

void WorkerModel::SayHello() {
  wire::Hello hello;
  hello.set_protocol(3);
  hello.mutable_build()->set_version(traits_.build);
  hello.set_host(name_);
  hello.set_slots(traits_.slots);
  hello.set_process(std::stoull(name_.substr(1)) + 1);
  world_.network.ToCoordinator(name_, coordinator::WorkerHello{name_, hello});
}

void WorkerModel::KeepSayingHello() {
  if (!alive_) return;
  if (!welcomed_ && !refused_ && world_.schedule.now_s() >= stopped_until_s_) SayHello();
  world_.schedule.After(1.7, [this] { KeepSayingHello(); });
}

void WorkerModel::KeepHeartbeat() {
  if (!alive_) return;
  if (welcomed_ && world_.schedule.now_s() >= stopped_until_s_) {
    wire::Heartbeat heartbeat;
    for (const Held& held : queue_) {
      *heartbeat.add_tasks() = held.assign.key();
      heartbeat.add_ticks(held.ticks);
    }
    if (!queue_.empty() && computing_ && !hung_) ++queue_.front().ticks;
    world_.network.ToCoordinator(name_, coordinator::WorkerHeartbeat{name_, heartbeat});
    if (terminated_) world_.network.ToCoordinator(name_, coordinator::DrainWorker{name_});
  }
  // A clock that jumped makes a heartbeat come too early or too late.
  const double wait_s = std::max(0.01, 0.9 - std::exchange(clock_jump_s_, 0));
  world_.schedule.After(wait_s, [this] { KeepHeartbeat(); });
}

// Again and again, until it has come: any message may be lost.
void WorkerModel::KeepFetching() {
  if (!alive_) return;
  if (welcomed_ && world_.schedule.now_s() >= stopped_until_s_) {
    for (const Held& held : queue_) {
      for (const auto& [name, fetch] : held.lacking) {
        world_.Count(kFetchedAgain);
        world_.network.ToCoordinator(name_, fetch);
      }
    }
  }
  world_.schedule.After(1.1, [this] { KeepFetching(); });
}

void WorkerModel::Receive(const wire::Envelope& message) {
  if (!alive_) return;
  if (const double wait_s = stopped_until_s_ - world_.schedule.now_s(); wait_s > 0)
    return world_.schedule.After(wait_s, [this, message] { Receive(message); });
  if (world_.Chance(world_.faults.crash_at_message)) {
    world_.Count(kWorkerKilledAtMessage);
    return Crash();
  }
  if (message.has_welcome()) welcomed_ = true;
  if (message.has_refuse()) {
    if (!Foreign()) world_.checks.Fail(name_ + " was refused: " + message.refuse().reason());
    refused_ = true;
  }
  if (message.has_unknown_worker() && draining_) return Leave();
  if (message.has_unknown_worker() && !refused_) {
    if (world_.rng.Below(2) == 0) Forget();
    SayHello();
  }
  if (message.has_assign()) Take(message.assign());
  if (message.has_blob()) Take(message.blob());
  if (message.has_missing()) Take(message.missing());
  if (message.has_cancel() && !hung_) Drop(message.cancel().key());
  if (message.has_drain()) draining_ = true;
  LeaveIfDrained();
}

void WorkerModel::LeaveIfDrained() {
  if (!alive_ || !draining_ || hung_ || !queue_.empty()) return;
  world_.Count(kWorkerDrained);
  Leave();
}

void WorkerModel::BeTerminated() {
  world_.Say(name_ + " is told to end");
  world_.Count(kWorkerTerminated);
  draining_ = terminated_ = true;
  world_.network.ToCoordinator(name_, coordinator::DrainWorker{name_});
  LeaveIfDrained();
  world_.schedule.After(world_.rng.Uniform(0.1, 20), [this] {
    if (alive_) Leave();
  });
}

void WorkerModel::Take(const wire::Assign& assign) {
  if (Foreign()) world_.checks.Fail(name_ + " of another build was given a task");
  const auto same = [&](const Held& held) { return SameAttempt(held.assign.key(), assign.key()); };
  if (std::any_of(queue_.begin(), queue_.end(), same)) return;
  Held& held = queue_.emplace_back(Held{assign, 0, FetchesOf(assign)});
  std::erase_if(held.lacking, [this](const auto& lacked) { return has_.contains(lacked.first); });
  for (const auto& [name, fetch] : held.lacking) world_.network.ToCoordinator(name_, fetch);
  BeginNext();
}

void WorkerModel::Take(const wire::BlobData& data) {
  if (world_.Chance(world_.faults.blob_damage)) return world_.Count(kFetchDamaged);  // its hash says so
  if (data.has_part()) world_.Count(kPartFetched);
  const Hash name = NameOf(data.of(), data.has_part() ? &data.part() : nullptr);
  has_.insert(name);
  for (Held& held : queue_) held.lacking.erase(name);
  BeginNext();
}

void WorkerModel::Take(const wire::Missing& missing) {
  const Hash name = NameOf(missing.hash(), missing.has_part() ? &missing.part() : nullptr);
  for (Held& held : queue_) {
    if (held.lacking.erase(name) == 0) continue;
    world_.Count(kBlobMissing);
    held.hopeless = true;
  }
  BeginNext();
}

void WorkerModel::Drop(const wire::TaskKey& key) {
  if (queue_.empty()) return;
  const bool first = SameAttempt(queue_.front().assign.key(), key);
  std::erase_if(queue_, [&](const Held& held) { return SameAttempt(held.assign.key(), key); });
  if (!first) return;
  computing_ = false;
  ++computation_;
  BeginNext();
}

void WorkerModel::BeginNext() {
  if (computing_ || queue_.empty() || hung_ || !queue_.front().lacking.empty()) return;
  computing_ = true;
  const std::uint64_t number = ++computation_;
  const double takes_s = world_.rng.Uniform(0.2, 2) * world_.faults.task_s / traits_.speed;
  world_.schedule.After(takes_s, [this, number] {
    if (!alive_ || hung_ || !computing_ || number != computation_) return;
    const double wait_s = stopped_until_s_ - world_.schedule.now_s();
    if (wait_s <= 0) return FinishFirst();
    computing_ = false;
    world_.schedule.After(wait_s, [this, number] {
      if (alive_ && number == computation_) BeginNext();
    });
  });
}

void WorkerModel::FinishFirst() {
  const Held held = queue_.front();
  queue_.pop_front();
  computing_ = false;
  if (world_.Chance(world_.faults.crash_at_message)) {
    world_.Count(kWorkerKilledBeforeAnswer);
    return Crash();
  }
  SendAnswer(held);
  if (world_.Chance(world_.faults.crash_at_message)) {
    world_.Count(kWorkerKilledAfterAnswer);
    return Crash();
  }
  LeaveIfDrained();
  if (alive_) BeginNext();
}

void WorkerModel::SendAnswer(const Held& held) {
  const wire::Assign& assign = held.assign;
  const ToyAnswer toy = ComputeToy(assign);
  const bool trouble = world_.Chance(world_.faults.task_crash);
  if (trouble) world_.Count(kTaskTrouble);
  if (trouble || held.hopeless || toy.input_error || toy.fails || !world_.shell().Serves(assign, name_)) {
    wire::Failed failed;
    *failed.mutable_key() = assign.key();
    failed.set_message(toy.input_error ? "bad input" : "trouble");
    failed.set_input_error(toy.input_error);
    world_.network.ToCoordinator(name_, coordinator::TaskFailed{name_, failed});
  } else if (traits_.lies && world_.Chance(world_.faults.lie)) {
    for (const Answer& lie : TellLies(world_, name_, assign, toy))
      world_.network.ToCoordinator(name_, lie.event, lie.whole);
  } else {
    world_.network.ToCoordinator(name_, TellTruth(name_, assign, toy).event);
  }
}

void WorkerModel::Forget() {
  if (!queue_.empty()) world_.Count(kWorkerForgot);
  queue_.clear();
  computing_ = false;
  ++computation_;
}

void WorkerModel::Crash() {
  world_.Say(name_ + " dies");
  alive_ = false;
  Forget();
  if (!world_.faults.tell_deaths) return;
  world_.schedule.After(world_.rng.Uniform(0, 2),
                        [this] { world_.shell().Deliver(coordinator::WorkerLost{name_, true}); });
}

void WorkerModel::Leave() {
  world_.Say(name_ + " leaves");
  world_.network.ToCoordinator(name_, coordinator::WorkerLeave{name_});
  alive_ = false;
  Forget();
}

void WorkerModel::BreakConnection() {
  world_.Say(name_ + " loses its connection");
  world_.Count(kWorkerBroken);
  welcomed_ = false;
  Forget();
  world_.schedule.After(world_.rng.Uniform(0, 2),
                        [this] { world_.shell().Deliver(coordinator::WorkerLost{name_}); });
  LeaveIfDrained();
}

void WorkerModel::Hang() {
  world_.Say(name_ + " hangs");
  world_.Count(kWorkerHung);
  hung_ = true;
  if (world_.rng.Below(3) == 0) return;  // for good
  world_.schedule.After(world_.rng.Uniform(2, 30), [this] {
    if (!alive_ || !hung_) return;
    world_.Say(name_ + " moves again");
    world_.Count(kWorkerUnhung);
    hung_ = false;
    computing_ = false;
    BeginNext();
  });
}

void WorkerModel::StopUntil(double until_s) {
  world_.Say(name_ + " is stopped until " + std::to_string(until_s));
  world_.Count(kWorkerStopped);
  stopped_until_s_ = until_s;
}

}  // namespace cairn::simulation
