#include "tests/simulation/size_world.h"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "schema/hash.h"

namespace cairn::simulation {
namespace {

using namespace coordinator;  // NOLINT: events and actions, all over this file

constexpr double kLatency_s = 0.0005, kTick_s = 0.1, kHandshake_s = 5, kWrite_s = 0.5;
constexpr double kFirstPause_s = 0.1, kLongestPause_s = 2;
constexpr double kTurnedAway_us = 20;

double ThreadSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Hash NumberedHash(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  Hasher hasher;
  hasher.Add(a);
  hasher.Add(b);
  hasher.Add(c);
  return hasher.Finish();
}

Cause CauseOf(const Event& event) {
  if (std::holds_alternative<WorkerHello>(event)) return Cause::kJoin;
  if (std::holds_alternative<WorkerHeartbeat>(event)) return Cause::kHeartbeat;
  return Cause::kTask;
}

Cause CauseOf(const wire::Envelope& message) {
  const bool of_task = message.has_assign() || message.has_cancel();
  return of_task ? Cause::kTask : Cause::kJoin;
}

proto::Job EmptyJob(std::uint64_t seed) {
  proto::Job job;
  job.set_name("size");
  job.set_seed(seed);
  proto::Stage& stage = *job.add_stages();
  stage.set_name("size");
  stage.set_pipeline("size");
  return job;
}

}  // namespace

bool SizeWorld::IsOfCoordinator(What what) {
  return what == What::kTick || what == What::kPersisted || what == What::kTurn;
}

SizeWorld::SizeWorld(const SizeOptions& options) : options_(options), rng_(1), workers_(options.workers) {}

SizeOutcome SizeWorld::Run() {
  Start();
  for (std::uint32_t i = 0; i < workers_.size(); ++i) Push(rng_.Uniform() * options_.join_s, What::kKnock, i);
  const auto until = [this](double end_s) {
    while (!happenings_.empty() && happenings_.top().at_s < end_s) {
      Happening happening = happenings_.top();
      happenings_.pop();
      now_s_ = happening.at_s;
      Happen(happening);
    }
    now_s_ = end_s;
  };
  const double begins_s = 1.5 * options_.join_s;
  until(begins_s);
  done_ = 0;
  spent_ = {};
  core_s_ = 0;
  outcome_ = {};
  outcome_.joined = static_cast<std::uint32_t>(core_->fleet().size());
  for (Worker& worker : workers_) worker.busy_s = 0;
  until(begins_s + options_.seconds);
  outcome_.tasks_per_s = static_cast<double>(done_) / options_.seconds;
  double busy_s = 0;
  for (const Worker& worker : workers_) busy_s += worker.busy_s;
  outcome_.busy = busy_s / options_.seconds / static_cast<double>(workers_.size());
  outcome_.core = core_s_ / options_.seconds;
  for (std::size_t k = 0; k < kCauses; ++k) {
    outcome_.a_second[k] = {spent_[k].loop_s / options_.seconds, spent_[k].sockets_s / options_.seconds};
    outcome_.loop += outcome_.a_second[k].loop_s;
    outcome_.sockets += outcome_.a_second[k].sockets_s;
  }
  Kill();
  until(begins_s + 2 * options_.seconds);
  return outcome_;
}

void SizeWorld::Push(double in_s, What what, std::uint32_t worker, std::optional<Event> event,
                     std::optional<wire::Envelope> message) {
  const std::uint32_t generation = worker < workers_.size() ? workers_[worker].generation : 0;
  happenings_.push({now_s_ + in_s, next_order_++, what, worker, IsOfCoordinator(what) ? epoch_ : generation,
                    std::move(event), std::move(message)});
}

void SizeWorld::Happen(Happening& happening) {
  const bool of_coordinator = IsOfCoordinator(happening.what);
  if (happening.generation != (of_coordinator ? epoch_ : workers_[happening.worker].generation)) return;
  switch (happening.what) {
    case What::kKnock:
      return Knock(happening.worker);
    case What::kHandshake:
      Push(kLatency_s, What::kHear, happening.worker, {}, wire::Envelope());
      return;
    case What::kArrive:
      return Push(Sockets(options_.socket_us, CauseOf(*happening.event)), What::kQueue, happening.worker,
                  std::move(happening.event));
    case What::kQueue:
    case What::kPersisted:
      return Queue(happening.worker, std::move(*happening.event));
    case What::kTurn:
      return Turn();
    case What::kHear:
      return Hear(happening.worker, *happening.message);
    case What::kTaskEnd:
      return EndTask(happening.worker);
    case What::kHeartbeat:
      return SayHeartbeat(happening.worker);
    case What::kTick:
      if (queue_.empty() && now_s_ >= loop_free_s_) Tick();
      return Push(kTick_s, What::kTick);
  }
}

void SizeWorld::Start() {
  ++epoch_;
  CoreOptions core_options;
  core_.emplace(core_options);
  core_began_s_ = now_s_;
  loop_free_s_ = sockets_free_s_ = ticked_s_ = now_s_;
  up_ = true;
  newcomers_ = 0;
  queue_.clear();
  numbers_.clear();
  for (Worker& worker : workers_) worker.worked = false;
  for (std::uint32_t job = 0; job < options_.jobs; ++job)
    Handle(SubmitJob{std::to_string(job + 1) + "-size", EmptyJob(job), {}}, Cause::kTask);
  Push(kTick_s, What::kTick);
}

// Everybody's connection ends; who comes before it listens again tries later.
void SizeWorld::Kill() {
  killed_s_ = now_s_;
  Start();
  up_ = false;
  loop_free_s_ = sockets_free_s_ = now_s_ + options_.restart_s;
  for (std::uint32_t i = 0; i < workers_.size(); ++i) TryLater(i);
}

void SizeWorld::TryLater(std::uint32_t number) {
  Worker& worker = workers_[number];
  ++worker.generation;
  worker.assigned.clear();
  worker.newcomer = false;
  worker.pause_s = std::clamp(2 * worker.pause_s, kFirstPause_s, kLongestPause_s);
  Push(worker.pause_s * (1 + rng_.Uniform()), What::kKnock, number);
}

double SizeWorld::Sockets(double us, Cause cause) {
  sockets_free_s_ = std::max(sockets_free_s_, now_s_) + us * 1e-6;
  Of(cause).sockets_s += us * 1e-6;
  return sockets_free_s_ - now_s_;
}

void SizeWorld::Knock(std::uint32_t number) {
  if (!up_ && now_s_ >= killed_s_ + options_.restart_s) up_ = true;
  if (!up_) return TryLater(number);
  if (newcomers_ >= options_.newcomers) {
    ++outcome_.turned_away;
    Sockets(kTurnedAway_us, Cause::kJoin);
    return TryLater(number);
  }
  const double through_s = Sockets(options_.join_us, Cause::kJoin);
  if (through_s > kHandshake_s) return TryLater(number);
  ++newcomers_;
  workers_[number].newcomer = true;
  Push(through_s, What::kHandshake, number);
}

void SizeWorld::Tick() {
  for (const auto& [peer, worker] : core_->fleet().workers())
    outcome_.longest_silence_s =
        std::max(outcome_.longest_silence_s, now_s_ - core_began_s_ - worker.heard_s);
  if (ticked_s_ > 0) outcome_.longest_tick_s = std::max(outcome_.longest_tick_s, now_s_ - ticked_s_);
  ticked_s_ = now_s_;
  Handle(coordinator::Tick{queue_.size() >= 256}, Cause::kTick);
}

void SizeWorld::Queue(std::uint32_t number, Event event) {
  queue_.emplace_back(number, std::move(event));
  if (queue_.size() == 1) Push(std::max(0.0, loop_free_s_ - now_s_), What::kTurn);
}

// The event loop takes one message.
void SizeWorld::Turn() {
  const auto [number, event] = std::move(queue_.front());
  if (now_s_ - ticked_s_ >= kTick_s) Tick();
  loop_free_s_ = std::max(loop_free_s_, now_s_) + options_.message_us * 1e-6;
  Of(CauseOf(event)).loop_s += options_.message_us * 1e-6;
  if (std::holds_alternative<WorkerHello>(event) && std::exchange(workers_[number].newcomer, false))
    --newcomers_;
  Handle(event, CauseOf(event));
  queue_.pop_front();
  if (!queue_.empty()) Push(loop_free_s_ - now_s_, What::kTurn);
}

void SizeWorld::Handle(const Event& event, Cause cause) {
  const double began_s = ThreadSeconds();
  std::vector<Action> actions = core_->Handle(event, now_s_ - core_began_s_);
  double took_s = ThreadSeconds() - began_s;
  core_s_ += took_s;
  std::vector<std::pair<std::uint32_t, wire::Envelope>> sends;
  for (Action& action : actions) {
    if (auto* send = std::get_if<Send>(&action)) {
      const auto number = numbers_.find(send->peer);
      if (number == numbers_.end()) continue;
      took_s += options_.message_us * 1e-6;
      sends.emplace_back(number->second, std::move(send->message));
    } else if (const auto* persist = std::get_if<Persist>(&action)) {
      Push(kWrite_s, What::kPersisted, 0,
           PersistDone{persist->checkpoint.job_id(), persist->checkpoint.number()});
    } else if (const auto* report = std::get_if<Report>(&action)) {
      outcome_.lost += report->text.find("was not heard of") != std::string::npos;
    }
  }
  loop_free_s_ = std::max(loop_free_s_, now_s_) + took_s;
  Of(cause).loop_s += took_s;
  for (auto& [number, message] : sends) {
    const double in_s =
        std::max(Sockets(options_.socket_us, CauseOf(message)), loop_free_s_ - now_s_) + kLatency_s;
    Push(in_s, What::kHear, number, {}, std::move(message));
  }
}

// What is empty stands for the end of its handshake.
void SizeWorld::Hear(std::uint32_t number, const wire::Envelope& message) {
  Worker& worker = workers_[number];
  if (message.body_case() == wire::Envelope::BODY_NOT_SET || message.has_unknown_worker()) {
    worker.pause_s = 0;
    worker.assigned.clear();
    worker.peer = "w" + std::to_string(number) + "-" + std::to_string(worker.generation);
    numbers_[worker.peer] = number;
    wire::Hello hello;
    hello.set_protocol(CoreOptions().protocol);
    hello.set_process(number + 1);
    hello.set_slots(options_.slots);
    Push(kLatency_s, What::kArrive, number, WorkerHello{worker.peer, hello});
  } else if (message.has_welcome()) {
    worker.heartbeat_s = message.welcome().heartbeat_s();
    Push(rng_.Uniform() * worker.heartbeat_s / 2, What::kHeartbeat, number);
  } else if (message.has_assign()) {
    worker.assigned.push_back(message.assign().key());
    if (worker.assigned.size() == 1) Push(options_.task_s * (0.5 + rng_.Uniform()), What::kTaskEnd, number);
    if (std::exchange(worker.worked, true)) return;
    std::uint32_t back = 0;
    if (killed_s_ > 0 && (back = ++outcome_.back) == workers_.size()) outcome_.back_s = now_s_ - killed_s_;
  } else if (message.has_cancel() && worker.assigned.size() > 1) {
    const wire::TaskKey& key = message.cancel().key();
    const auto waits = std::find_if(worker.assigned.begin() + 1, worker.assigned.end(),
                                    [&](const wire::TaskKey& has) { return SameAttempt(has, key); });
    if (waits != worker.assigned.end()) worker.assigned.erase(waits);
  }
}

void SizeWorld::EndTask(std::uint32_t number) {
  Worker& worker = workers_[number];
  const wire::TaskKey key = worker.assigned.front();
  worker.assigned.pop_front();
  worker.busy_s += options_.task_s;
  TaskDone done{worker.peer, {}, {}};
  *done.done.mutable_key() = key;
  if (key.kind() == wire::TaskKey::RUN) {
    done.blobs = {NumberedHash(std::hash<std::string>()(key.job()), key.round(), key.task())};
    done.done.set_partial(done.blobs[0].Binary());
    ++done_;
  } else {
    proto::Step& step = *done.done.mutable_step();
    (*step.mutable_state()->mutable_scalars())["round"].set_i(static_cast<std::int64_t>(key.round()));
    const std::uint32_t tasks = std::max(1u, options_.workers * options_.tasks_a_worker / options_.jobs);
    for (std::uint32_t i = 0; i < tasks; ++i) {
      step.add_tasks()->set_index(i);
      step.mutable_tasks(static_cast<int>(i))->set_cost(1);
    }
  }
  Push(kLatency_s, What::kArrive, number, std::move(done));
  if (!worker.assigned.empty()) Push(options_.task_s * (0.5 + rng_.Uniform()), What::kTaskEnd, number);
}

void SizeWorld::SayHeartbeat(std::uint32_t number) {
  Worker& worker = workers_[number];
  WorkerHeartbeat heartbeat{worker.peer, {}};
  for (const wire::TaskKey& key : worker.assigned) {
    *heartbeat.heartbeat.add_tasks() = key;
    heartbeat.heartbeat.add_ticks(static_cast<std::uint64_t>(now_s_));
  }
  Push(kLatency_s, What::kArrive, number, std::move(heartbeat));
  Push(worker.heartbeat_s / 2, What::kHeartbeat, number);
}

}  // namespace cairn::simulation
