// Handshake, heartbeats, leases: who is there and whether it moves.
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "coordinator/core/core.h"

namespace cairn::coordinator {
namespace {

// Without zeros that say nothing.
std::string Number(double value) { return fmt::format("{:g}", value); }

}  // namespace

std::optional<wire::Refusal> Core::WhyRefused(const wire::Hello& hello) const {
  using wire::RefusalKind;
  if (hello.protocol() != options_.protocol)
    return wire::Refusal{RefusalKind::kVersion, "it speaks protocol " + std::to_string(hello.protocol()) +
                                                    ", here it is " + std::to_string(options_.protocol)};
  if (hello.slots() == 0) return wire::Refusal{RefusalKind::kMalformed, "it offers no slots"};
  const std::string difference = BuildDifference(options_.build, hello.build());
  if (difference.empty()) return std::nullopt;
  return wire::Refusal{RefusalKind::kBuild, difference};
}

void Core::On(const WorkerHello& event) {
  const wire::Hello& hello = event.hello;
  // Before its build is looked at anew.
  bool draining = Forget(fleet_.Find(event.peer), "began anew");
  draining |= Forget(fleet_.FindProcess(hello), "came back over another connection");
  if (std::optional<wire::Refusal> refusal = WhyRefused(hello)) {
    Send send{event.peer, {}};
    send.message.mutable_refuse()->set_reason(refusal->reason);
    actions_.push_back(std::move(send));
    refusal->reason = WorkerName(hello) + ": " + refusal->reason;
    actions_.push_back(Refused{event.peer, std::move(*refusal)});
    return;
  }
  Worker& worker = fleet_.Add(event.peer, hello, now_s_);
  worker.heartbeat_s = HeartbeatSeconds();
  Send send{event.peer, {}};
  send.message.mutable_welcome()->set_heartbeat_s(worker.heartbeat_s);
  actions_.push_back(std::move(send));
  SayMoved(Report::kInfo, WorkerName(hello) + " joined");
  TakeBackBlame(hello);
  if (draining) BeginDraining(worker);
}

// Ten thousand workers that say twice a second that they are there would leave room for little else.
double Core::HeartbeatSeconds() const {
  constexpr double kMany = 2500, kSlowest = 3;
  return options_.heartbeat_s * std::clamp(static_cast<double>(fleet_.size()) / kMany, 1.0, kSlowest);
}

// Who may join may do so, and leave, a thousand times a second: the log is not to fill a disk.
void Core::SayMoved(Report::Level level, const std::string& what) {
  constexpr double kAtOnce = 1000, kPerS = 10;
  moves_.room = std::min(kAtOnce, moves_.room + kPerS * (now_s_ - moves_.counted_s));
  moves_.counted_s = now_s_;
  if (moves_.room < 1) {
    ++moves_.unsaid;
    return;
  }
  --moves_.room;
  Say(level, what + (moves_.unsaid > 0 ? " (" + std::to_string(moves_.unsaid) + " more came or went)" : ""));
  moves_.unsaid = 0;
}

// Nobody to blame, unless it says so again and again.
bool Core::Forget(Worker* known, const std::string& how) {
  if (known == nullptr) return false;
  const bool draining = known->draining;
  const std::string what = WorkerName(known->hello) + " " + how;
  const bool excused = Excuse(*known);
  if (excused) WarnOfLink(*known);
  Lose(*known, what, excused ? "" : what + " while it ran, once more");
  return draining;
}

// What it was sent of its task's inputs is lost with each connection, and goes over the next anew.
void Core::WarnOfLink(const Worker& worker) {
  const Job* job = JobOfRunning(worker);
  if (job == nullptr) return;
  const std::uint32_t task = worker.assigned.front().key.task();
  const auto times = static_cast<unsigned>(job->tasks.task(task).excuses);
  if (times < 2 || !std::has_single_bit(times)) return;
  Say(Report::kWarning, *job,
      job->TaskName(task) + " was lost " + std::to_string(times) +
          " times, the last with the connection of " + WorkerName(worker.hello) +
          ", and begins anew each time: is the link to it cut, or too slow?");
}

Worker* Core::Heard(const std::string& peer) {
  Worker* worker = fleet_.Find(peer);
  if (worker != nullptr) {
    worker->heard_s = now_s_;
    fleet_.Trust(*worker);
    return worker;
  }
  Send send{peer, {}};
  send.message.mutable_unknown_worker();
  actions_.push_back(std::move(send));
  return nullptr;
}

void Core::On(const WorkerHeartbeat& event) {
  constexpr int kMostTasks = 10'000;  // far more than a worker ever has
  if (event.heartbeat.tasks_size() > kMostTasks) return;
  if (Worker* known = fleet_.Find(event.peer)) known->TakeVitals(event.heartbeat);
  Worker* worker = Heard(event.peer);
  if (worker == nullptr) return;
  const wire::Heartbeat& heartbeat = event.heartbeat;
  if (heartbeat.tasks_size() == 0 && !heartbeat.stuck()) fleet_.SetHung(*worker, false);
  for (int i = 0; i < heartbeat.tasks_size(); ++i) {
    const wire::TaskKey& key = heartbeat.tasks(i);
    if (worker->Find(key) == nullptr) {  // our Cancel was lost, or has not reached it yet
      Send send{worker->peer, {}};
      *send.message.mutable_cancel()->mutable_key() = key;
      actions_.push_back(std::move(send));
    } else if (i < heartbeat.ticks_size()) {
      worker->Tick(key, heartbeat.ticks(i), now_s_);
    }
  }
  DropUnlisted(*worker, heartbeat);
  if (worker->draining) TellDrain(*worker);  // the first word may have been lost
}

// A message may get lost where a connection breaks and comes back before the lease is over.
void Core::DropUnlisted(Worker& worker, const wire::Heartbeat& heartbeat) {
  std::vector<wire::TaskKey> lost;
  for (const AssignedTask& task : worker.assigned) {
    if (caught_up_s_ - task.since_s <= options_.unlisted_s) continue;
    const bool listed = std::any_of(heartbeat.tasks().begin(), heartbeat.tasks().end(),
                                    [&task](const wire::TaskKey& key) { return SameAttempt(key, task.key); });
    if (!listed) lost.push_back(task.key);
  }
  for (const wire::TaskKey& key : lost) Reclaim(worker, key);
}

void Core::On(const WorkerLeave& event) {
  Worker* worker = fleet_.Find(event.peer);
  if (worker == nullptr) return;
  const std::string what = WorkerName(worker->hello) + " left";
  SayMoved(Report::kInfo, what);
  Lose(*worker, what, "");
}

void Core::On(const WorkerLost& event) {
  Worker* worker = fleet_.Find(event.peer);
  if (worker == nullptr) return;
  const std::string what = WorkerName(worker->hello) + (event.ended ? " died" : " lost its connection");
  SayMoved(Report::kWarning, what);
  const bool may_be_the_network = !event.ended && !worker->assigned.empty();
  if (!event.ended) NoteLost(*worker);
  Lose(*worker, what, what + " while it ran");
  if (may_be_the_network) fleet_.DoubtAll();
}

void Core::On(const DrainWorker& event) {
  Worker* worker = fleet_.Find(event.peer);
  if (worker == nullptr || worker->draining) return;
  Say(Report::kInfo, WorkerName(worker->hello) + " finishes what it runs, and leaves");
  BeginDraining(*worker);
}

// What it has queued goes elsewhere at once, nobody to blame.
void Core::BeginDraining(Worker& worker) {
  fleet_.SetDraining(worker);
  while (worker.assigned.size() > 1) Reclaim(worker, wire::TaskKey(worker.assigned.back().key));
  TellDrain(worker);
}

void Core::TellDrain(const Worker& worker) {
  Send send{worker.peer, {}};
  send.message.mutable_drain();
  actions_.push_back(std::move(send));
}

void Core::Lose(Worker& worker, const std::string& what, const std::string& blame) {
  const std::vector<AssignedTask> tasks = worker.assigned;
  std::map<std::string, int> moved;  // tasks, by job
  const std::uint64_t number = worker.number;
  fleet_.Remove(worker.peer);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const wire::TaskKey& key = tasks[i].key;
    Job* job = JobOf(key);
    if (job == nullptr || !job->tasks.Withdraw(key.task(), key.attempt())) continue;
    if (i == 0 && !blame.empty())
      FailAttempt(*job, key.task(), number, blame);
    else
      ++moved[job->id];
  }
  if (moves_.unsaid > 0) return;  // a job's log keeps its last lines: these would be all
  for (const auto& [id, count] : moved)
    Say(blame.empty() ? Report::kInfo : Report::kWarning, *FindJob(id),
        what + ": " + std::to_string(count) + " of the tasks that it had " + (count == 1 ? "goes" : "go") +
            " elsewhere");
}

void Core::GiveUp(Worker& worker, const std::string& why) {
  Say(Report::kWarning, WorkerName(worker.hello) + " gets nothing until it moves: its task " + why);
  fleet_.SetHung(worker, true);
  const wire::TaskKey head = worker.assigned.front().key;
  Job* job = nullptr;  // of the head, which is taken last
  while (!worker.assigned.empty()) job = Reclaim(worker, wire::TaskKey(worker.assigned.back().key));
  if (job != nullptr)
    FailAttempt(*job, head.task(), worker.number, "it " + why + " on " + WorkerName(worker.hello));
}

// It sends heartbeats, but what it runs does not move, or runs for too long.
std::string Core::WhyGiveUp(const Worker& worker) const {
  if (worker.assigned.empty()) return "";
  const wire::TaskKey& key = worker.assigned.front().key;
  const double hung_s = key.kind() == wire::TaskKey::RUN ? options_.hung_s : options_.plan_hung_s;
  if (now_s_ - worker.moved_s > hung_s)
    return "did not move for " + std::to_string(static_cast<int>(now_s_ - worker.moved_s)) + " s";
  const Job* job = FindJob(key.job());
  if (job == nullptr) return "";
  const bool own = job->spec.task_time_s() > 0;
  const double limit_s = own ? job->spec.task_time_s() : options_.task_time_s;
  if (limit_s <= 0 || now_s_ - worker.head_s <= limit_s) return "";
  return "ran for more than " + Number(limit_s) + " s, " +
         (own ? "its limit (task_time_s)" : "the coordinator's limit (--task-time-s)");
}

// Whatever comes first after the coordinator was stopped, or its machine slept, tells it: what its workers
// sent meanwhile still waits to be read. A little of that time does count, lest one that always comes round
// late never finds out who is gone.
void Core::LeaveOutStandstill() {
  constexpr double kStandsStill = 0.5, kCounts = 0.1;  // of the lease
  if (!ticked_s_ || now_s_ - *ticked_s_ <= kStandsStill * options_.lease_s) return;
  const double gap_s = now_s_ - *ticked_s_;
  const double left_out_s = gap_s - kCounts * options_.lease_s;
  ticked_s_ = now_s_;
  fleet_.LeaveOut(left_out_s, now_s_);
  served_from_s_ += left_out_s;  // nobody was served: no job grew older
  for (auto& [process, lost] : lost_) lost.since_s = std::min(now_s_, lost.since_s + left_out_s);
  if (fleet_.size() > 0)
    Say(Report::kWarning, "the coordinator stood still for " + std::to_string(static_cast<int>(gap_s)) +
                              " s, which counts for no worker's silence");
}

void Core::On(const Tick& event) {
  all_touched_ = true;
  behind_ = event.behind;
  if (!behind_) caught_up_s_ = now_s_;
  ticked_s_ = now_s_;
  std::erase_if(lost_, [this](const auto& entry) { return now_s_ - entry.second.since_s > options_.back_s; });
  LookAtWorkers();
  if (options_.keep_s > 0) DeleteTheOld();
}

// Ten times a second would, of a hundred thousand, be half of the event loop's time.
void Core::LookAtWorkers() {
  constexpr double kMostPerS = 100'000;
  constexpr double kBehindCounts = 6;  // leases: one that is behind for ever must find out, too
  if (looked_s_ && now_s_ - *looked_s_ < static_cast<double>(fleet_.size()) / kMostPerS) return;
  looked_s_ = now_s_;
  workers_due_ = true;
  std::vector<std::string> silent;
  std::vector<std::pair<std::string, std::string>> given_up;
  for (const auto& [number, worker] : fleet_.workers()) {
    if (caught_up_s_ - worker.heard_s > options_.lease_s ||
        now_s_ - worker.heard_s > kBehindCounts * options_.lease_s)
      silent.push_back(worker.peer);
    else if (const std::string why = WhyGiveUp(worker); !why.empty())
      given_up.emplace_back(worker.peer, why);
  }
  for (const std::string& peer : silent) {
    Worker& worker = *fleet_.Find(peer);
    const std::string what = WorkerName(worker.hello) + " was not heard of for " +
                             std::to_string(static_cast<int>(now_s_ - worker.heard_s)) + " s";
    Say(Report::kWarning, what);
    const bool excused = LoseWithNode(worker);
    if (!excused) NoteLost(worker);
    Lose(worker, what, excused ? "" : what);
  }
  if (!silent.empty()) fleet_.DoubtAll();
  for (const auto& [peer, why] : given_up) GiveUp(*fleet_.Find(peer), why);
}

}  // namespace cairn::coordinator
