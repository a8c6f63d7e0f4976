#include "tests/simulation/worker_model.h"

#include <algorithm>

#include "coordinator/fleet.h"
#include "tests/simulation/world.h"

namespace cairn::simulation {

using coordinator::SameAttempt;

WorkerModel::WorkerModel(World& world, std::string name, std::string build, double speed, std::uint32_t slots)
    : world_(world), name_(std::move(name)), build_(std::move(build)), speed_(speed), slots_(slots) {}

void WorkerModel::Start() {
  world_.Say(name_ + " starts" + (build_ == "1" ? "" : ", another build") + (speed_ < 1 ? ", slow" : ""));
  KeepSayingHello();
  BeatOn();
}

void WorkerModel::SayHello() {
  wire::Hello hello;
  hello.set_protocol(1);
  hello.mutable_build()->set_version(build_);
  hello.set_host(name_);
  hello.set_slots(slots_);
  world_.ToCoordinator(name_, coordinator::WorkerHello{name_, hello});
}

void WorkerModel::KeepSayingHello() {
  if (!alive_) return;
  if (!welcomed_ && !refused_) SayHello();
  world_.schedule.After(1.7, [this] { KeepSayingHello(); });
}

void WorkerModel::BeatOn() {
  if (!alive_) return;
  if (welcomed_) {
    wire::Beat beat;
    for (Held& held : queue_) {
      *beat.add_tasks() = held.assign.key();
      beat.add_ticks(held.ticks);
    }
    if (!queue_.empty() && computing_ && !hung_) ++queue_.front().ticks;
    world_.ToCoordinator(name_, coordinator::WorkerBeat{name_, beat});
  }
  world_.schedule.After(0.9, [this] { BeatOn(); });
}

void WorkerModel::Receive(const wire::Envelope& message) {
  if (!alive_) return;
  if (message.has_welcome()) welcomed_ = true;
  if (message.has_refuse()) {
    if (build_ == "1") world_.checks.Fail(name_ + " was refused: " + message.refuse().reason());
    refused_ = true;
  }
  if (message.has_stranger() && !refused_) {
    if (world_.rng.Below(2) == 0) Forget();
    SayHello();
  }
  if (message.has_assign()) {
    if (build_ != "1") world_.checks.Fail(name_ + " of another build was given a task");
    const auto same = [&](const Held& held) {
      return SameAttempt(held.assign.key(), message.assign().key());
    };
    if (std::any_of(queue_.begin(), queue_.end(), same)) return;
    queue_.push_back({message.assign()});
    BeginNext();
  }
  if (message.has_cancel() && !hung_) {
    if (queue_.empty()) return;
    const bool first = SameAttempt(queue_.front().assign.key(), message.cancel().key());
    std::erase_if(queue_,
                  [&](const Held& held) { return SameAttempt(held.assign.key(), message.cancel().key()); });
    if (!first) return;
    computing_ = false;
    ++computation_;
    BeginNext();
  }
}

void WorkerModel::BeginNext() {
  if (computing_ || queue_.empty() || hung_) return;
  computing_ = true;
  const std::uint64_t number = ++computation_;
  const double takes_s = world_.rng.Uniform(0.2, 2) * world_.faults.task_s / speed_;
  world_.schedule.After(takes_s, [this, number] {
    if (alive_ && !hung_ && computing_ && number == computation_) FinishFirst();
  });
}

bool WorkerModel::HasInputs(const wire::Assign& assign) {
  std::set<Hash> inputs;
  const auto add = [&](const std::string& binary) { inputs.insert(Hash::FromBinary(binary).value()); };
  for (const proto::InputRef& input : assign.task().inputs()) add(input.blob());
  for (const auto& [name, hash] : assign.inputs()) add(hash);
  for (const auto& [name, hash] : assign.state().blobs()) add(hash);
  for (const std::string& partial : assign.partials()) add(partial);
  return world_.shell().Serves(assign.key(), name_, inputs);
}

void WorkerModel::FinishFirst() {
  const wire::Assign assign = queue_.front().assign;
  queue_.pop_front();
  computing_ = false;
  const ToyAnswer answer = ComputeToy(assign);
  if (!HasInputs(assign) || answer.input_error || world_.Chance(world_.faults.task_crash)) {
    wire::Failed failed;
    *failed.mutable_key() = assign.key();
    failed.set_message(answer.input_error ? "bad input" : "trouble");
    failed.set_input_error(answer.input_error);
    world_.ToCoordinator(name_, coordinator::TaskFailed{name_, failed});
  } else {
    wire::Done done;
    *done.mutable_key() = assign.key();
    if (assign.key().kind() == wire::TaskKey::RUN)
      done.set_partial(answer.partial.Binary());
    else
      *done.mutable_step() = answer.step;
    world_.ToCoordinator(name_, coordinator::TaskDone{name_, done, answer.blobs});
  }
  BeginNext();
}

void WorkerModel::Forget() {
  queue_.clear();
  computing_ = false;
  ++computation_;
}

void WorkerModel::Crash() {
  world_.Say(name_ + " dies");
  ++world_.outcome.worker_ends;
  alive_ = false;
  Forget();
  if (world_.faults.tell_deaths) world_.shell().Deliver(coordinator::WorkerLost{name_});
}

void WorkerModel::Leave() {
  world_.Say(name_ + " leaves");
  ++world_.outcome.worker_ends;
  world_.ToCoordinator(name_, coordinator::WorkerBye{name_});
  alive_ = false;
  Forget();
}

void WorkerModel::Hang() {
  world_.Say(name_ + " hangs");
  hung_ = true;
  if (world_.rng.Below(3) == 0) return;  // for good
  world_.schedule.After(world_.rng.Uniform(2, 30), [this] {
    if (!alive_ || !hung_) return;
    hung_ = false;
    computing_ = false;
    BeginNext();
  });
}

}  // namespace cairn::simulation
