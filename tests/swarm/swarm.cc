#include "tests/swarm/swarm.h"

#include <sys/epoll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <new>

#include "schema/build_info.h"
#include "schema/wire/codec.h"

namespace cairn::swarm {
namespace {

// As of a worker's socket (SocketOptions).
constexpr double kFirstPause_s = 0.1, kLongestPause_s = 2, kPingEvery_s = 5;

template <class T>
T* SharedMemory(std::size_t count) {
  void* memory = ::mmap(nullptr, std::max<std::size_t>(count, 1) * sizeof(T), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  CAIRN_DEMAND(memory != MAP_FAILED, "no memory");
  return new (memory) T[std::max<std::size_t>(count, 1)];
}

std::int64_t Option(const proto::Stage& stage, const std::string& name) {
  return stage.options().at(name).i();
}

proto::Step PlanRound(const proto::Stage& stage, std::int64_t round) {
  proto::Step step;
  (*step.mutable_state()->mutable_scalars())["round"].set_i(round);
  for (std::int64_t i = 0; i < Option(stage, "tasks"); ++i) {
    proto::Task& task = *step.add_tasks();
    task.set_index(static_cast<std::uint32_t>(i));
    task.set_cost(1);
  }
  return step;
}

BlobPtr ScalarBlob(const std::string& name, std::int64_t value) {
  Blob blob;
  blob.PutScalar(name, value);
  return std::make_shared<const Blob>(std::move(blob));
}

bool Same(const wire::TaskKey& a, const wire::TaskKey& b) {
  return a.task() == b.task() && a.attempt() == b.attempt() && a.round() == b.round() &&
         a.stage() == b.stage() && a.kind() == b.kind() && a.job() == b.job();
}

}  // namespace

std::int64_t NowNs() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

proto::Job MakeJob(const std::string& name, int tasks, int rounds, int task_ms) {
  proto::Job job;
  job.set_name(name);
  proto::Stage& stage = *job.add_stages();
  stage.set_name("empty");
  stage.set_pipeline("empty");
  (*stage.mutable_options())["tasks"].set_i(tasks);
  (*stage.mutable_options())["rounds"].set_i(rounds);
  (*stage.mutable_options())["task_ms"].set_i(task_ms);
  return job;
}

Shared::Shared(std::size_t workers, std::size_t tasks)
    : sums_(SharedMemory<Sums>(1)),
      given_ns_(SharedMemory<std::atomic<std::int64_t>>(workers)),
      given_in_(SharedMemory<std::atomic<int>>(workers)),
      runs_(SharedMemory<std::atomic<std::uint8_t>>(tasks)) {}

Swarm::Swarm(SwarmOptions options, const Shared& shared)
    : options_(std::move(options)),
      shared_(shared),
      build_(ThisBuild()),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      random_(static_cast<std::uint64_t>(options_.first) + 1),
      workers_(static_cast<std::size_t>(options_.count)) {
  now_s_ = static_cast<double>(NowNs()) * 1e-9;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    workers_[i].number = options_.first + static_cast<int>(i);
    At(now_s_, workers_[i], Due::kConnect);
  }
}

void Swarm::Serve() {
  std::array<epoll_event, 512> events{};
  while (true) {
    now_s_ = static_cast<double>(NowNs()) * 1e-9;
    // A few at a time, so that those who are connected are heard meanwhile.
    for (int i = 0; i < 1000 && !timers_.empty() && timers_.top().at_s <= now_s_; ++i) {
      const Timer timer = timers_.top();
      timers_.pop();
      Fire(timer);
    }
    const double wait_s = timers_.empty() ? 0.1 : std::clamp(timers_.top().at_s - now_s_, 0.0, 0.1);
    const int ready =
        ::epoll_wait(epoll_, events.data(), events.size(), static_cast<int>(std::ceil(wait_s * 1e3)));
    const std::int64_t began_ns = NowNs();
    now_s_ = static_cast<double>(began_ns) * 1e-9;
    for (int i = 0; i < ready; ++i) {
      Worker& worker = workers_[events[static_cast<std::size_t>(i)].data.u64 & 0xffffffff];
      if (worker.generation == events[static_cast<std::size_t>(i)].data.u64 >> 32) Turn(worker);
    }
    std::atomic<std::int64_t>& longest_ns = shared_.sums().longest_turn_ns;
    if (const std::int64_t took_ns = NowNs() - began_ns; took_ns > longest_ns) longest_ns = took_ns;
  }
}

void Swarm::At(double at_s, const Worker& worker, Due due) {
  timers_.push({at_s, worker.number - options_.first, worker.generation, due});
}

void Swarm::Fire(const Timer& timer) {
  Worker& worker = workers_[static_cast<std::size_t>(timer.worker)];
  if (timer.generation != worker.generation) return;
  switch (timer.due) {
    case Due::kConnect:
      return Connect(worker);
    case Due::kHeartbeat:
      SayHeartbeat(worker);
      At(now_s_ + worker.heartbeat_s / 2, worker, Due::kHeartbeat);
      break;
    case Due::kPing:
      worker.peer->Ping();
      At(now_s_ + kPingEvery_s, worker, Due::kPing);
      break;
    case Due::kTask:
      AnswerTask(worker, worker.assigned.front().key, worker.assigned.front().seconds);
      worker.assigned.pop_front();
      if (!worker.assigned.empty()) At(now_s_ + worker.assigned.front().seconds, worker, Due::kTask);
      break;
  }
  if (!worker.peer->Flush()) return Lose(worker);
  Watch(worker);
}

void Swarm::Connect(Worker& worker) {
  const int node = worker.number % options_.nodes;
  const std::string from =
      options_.nodes == 1 ? "" : "127.1." + std::to_string(node / 200) + "." + std::to_string(1 + node % 200);
  worker.epoch = shared_.sums().epoch;
  worker.peer = std::make_unique<ZmtpPeer>(
      options_.endpoint, from,
      options_.keys.empty() ? nullptr : &options_.keys[static_cast<std::size_t>(node)]);
  if (worker.peer->fd() < 0) return Lose(worker);
  worker.wants_to_write = true;
  epoll_event event{};
  event.events = EPOLLIN | EPOLLOUT;
  event.data.u64 =
      std::uint64_t{worker.generation} << 32 | static_cast<std::uint32_t>(worker.number - options_.first);
  ::epoll_ctl(epoll_, EPOLL_CTL_ADD, worker.peer->fd(), &event);
}

// What it had is forgotten; it comes back by itself, later and later, as ZeroMQ does.
void Swarm::Lose(Worker& worker) {
  if (worker.peer->fd() >= 0) ++shared_.sums().broken;
  shared_.sums().bytes_in += worker.peer->bytes_in();
  shared_.sums().bytes_out += worker.peer->bytes_out();
  worker.peer.reset();
  ++worker.generation;
  worker.said_hello = worker.welcome = false;
  worker.assigned.clear();
  worker.pause_s = std::clamp(2 * worker.pause_s, kFirstPause_s, kLongestPause_s);
  At(now_s_ + worker.pause_s * (1 + Random()), worker, Due::kConnect);
}

void Swarm::Watch(Worker& worker) {
  if (worker.wants_to_write == worker.peer->WantsToWrite()) return;
  worker.wants_to_write = worker.peer->WantsToWrite();
  epoll_event event{};
  event.events = worker.wants_to_write ? EPOLLIN | EPOLLOUT : EPOLLIN;
  event.data.u64 =
      std::uint64_t{worker.generation} << 32 | static_cast<std::uint32_t>(worker.number - options_.first);
  ::epoll_ctl(epoll_, EPOLL_CTL_MOD, worker.peer->fd(), &event);
}

void Swarm::Turn(Worker& worker) {
  std::vector<std::vector<std::string>> messages;
  if (!worker.peer->Turn(&messages)) return Lose(worker);
  if (worker.peer->Ready() && !worker.said_hello) SayHello(worker);
  for (const std::vector<std::string>& frames : messages) Take(worker, frames);
  if (!worker.peer->Flush()) return Lose(worker);
  Watch(worker);
}

void Swarm::SayHello(Worker& worker) {
  worker.said_hello = true;
  worker.pause_s = 0;
  ++shared_.sums().connections;
  wire::Envelope envelope;
  wire::Hello& hello = *envelope.mutable_hello();
  hello.set_protocol(wire::kProtocol);
  *hello.mutable_build() = build_;
  hello.set_host("node" + std::to_string(worker.number % options_.nodes));
  hello.set_pid(1000 + worker.number);
  hello.set_process(0x5731u + static_cast<std::uint64_t>(worker.number));
  hello.set_slots(static_cast<std::uint32_t>(options_.slots));
  Send(worker, std::move(envelope));
}

void Swarm::SayHeartbeat(Worker& worker) {
  ++shared_.sums().heartbeats;
  wire::Envelope envelope;
  wire::Heartbeat& heartbeat = *envelope.mutable_heartbeat();
  for (const Assigned& assigned : worker.assigned) {
    *heartbeat.add_tasks() = assigned.key;
    heartbeat.add_ticks(static_cast<std::uint64_t>(now_s_));
  }
  Send(worker, std::move(envelope));
}

void Swarm::Send(Worker& worker, wire::Envelope envelope) {
  worker.peer->Send({envelope.SerializeAsString()});
}

void Swarm::Take(Worker& worker, const std::vector<std::string>& frames) {
  wire::Envelope envelope;
  CAIRN_DEMAND(envelope.ParseFromString(frames[0]), "the coordinator said what is no message");
  switch (envelope.body_case()) {
    case wire::Envelope::kWelcome:
      worker.heartbeat_s = envelope.welcome().heartbeat_s();
      if (!std::exchange(worker.welcome, true)) {
        SayHeartbeat(worker);
        // Not all at once for ever: real workers began at different times.
        At(now_s_ + Random() * worker.heartbeat_s / 2, worker, Due::kHeartbeat);
        At(now_s_ + Random() * kPingEvery_s, worker, Due::kPing);
      }
      return;
    case wire::Envelope::kUnknownWorker:
      worker.assigned.clear();
      return SayHello(worker);
    case wire::Envelope::kAssign:
      ++shared_.sums().assigned;
      return TakeAssign(worker, envelope.assign());
    case wire::Envelope::kCancel:
      ++shared_.sums().called_back;
      return TakeCancel(worker, envelope.cancel().key());
    default:
      CAIRN_DEMAND(!envelope.has_refuse(), envelope.refuse().reason());
  }
}

void Swarm::TakeAssign(Worker& worker, const wire::Assign& assign) {
  const double seconds = static_cast<double>(Option(assign.stage(), "task_ms")) * 1e-3;
  if (assign.key().kind() != wire::TaskKey::RUN) return Answer(worker, assign);
  shared_.runs(assign.key().round() * static_cast<std::uint64_t>(Option(assign.stage(), "tasks")) +
               assign.key().task())++;
  const auto number = static_cast<std::size_t>(worker.number);
  if (shared_.given_in(number) != worker.epoch) {
    shared_.given_ns(number) = NowNs();
    shared_.given_in(number) = worker.epoch;
  }
  if (seconds == 0) return AnswerTask(worker, assign.key(), 0);
  worker.assigned.push_back({assign.key(), seconds});
  if (worker.assigned.size() == 1) At(now_s_ + seconds, worker, Due::kTask);
}

void Swarm::TakeCancel(Worker& worker, const wire::TaskKey& key) {
  for (std::size_t i = 1; i < worker.assigned.size(); ++i)  // what it runs it ends
    if (Same(worker.assigned[i].key, key)) {
      worker.assigned.erase(worker.assigned.begin() + static_cast<std::ptrdiff_t>(i));
      return;
    }
}

void Swarm::AnswerTask(Worker& worker, const wire::TaskKey& key, double seconds) {
  wire::Message answer;
  answer.blobs = {wire::NameBlob(ScalarBlob("task", key.task()))};
  wire::Done& done = *answer.envelope.mutable_done();
  *done.mutable_key() = key;
  done.set_partial(answer.blobs[0].hash.Binary());
  done.set_seconds(seconds);
  const wire::Frames frames = wire::Encode(std::move(answer));
  const auto bytes = frames.arrays[0].bytes();
  worker.peer->Send({frames.envelope, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}});
}

// The reduction is not done here, for want of the partials: their number is right if all came.
void Swarm::Answer(Worker& worker, const wire::Assign& assign) {
  const bool start = assign.key().kind() == wire::TaskKey::START;
  const std::int64_t round = start ? 0 : assign.state().scalars().at("round").i() + 1;
  wire::Message answer;
  wire::Done& done = *answer.envelope.mutable_done();
  *done.mutable_key() = assign.key();
  if (round < Option(assign.stage(), "rounds")) {
    *done.mutable_step() = PlanRound(assign.stage(), round);
    return worker.peer->Send({wire::Encode(std::move(answer)).envelope});
  }
  answer.blobs = {wire::NameBlob(ScalarBlob("partials", assign.partials_size()))};
  done.mutable_step()->set_result(answer.blobs[0].hash.Binary());
  const wire::Frames frames = wire::Encode(std::move(answer));
  const auto bytes = frames.arrays[0].bytes();
  worker.peer->Send({frames.envelope, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}});
}

}  // namespace cairn::swarm
