#include "tests/eta/replay.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "coordinator/core/core.h"
#include "coordinator/core/testing/test_job.h"
#include "schema/error.h"

namespace cairn::eta {
namespace {

using namespace coordinator;  // NOLINT: events and actions, all over this file

constexpr double kTick_s = 0.1, kHeartbeat_s = 1, kLook_s = 0.5;
constexpr double kMessage_s = 0.001;  // from a worker to the next task

class Replayer {
 public:
  Replayer(const Trace& trace, const eta::Fleet& fleet) : trace_(trace), core_(OptionsOfTest()) {
    for (; joined_ < fleet.workers;) Join();
    Do(SubmitJob{"job", TestJob(1, H(0)), {H(0)}});
  }

  std::vector<Said> Run(const eta::Fleet& fleet) {
    std::vector<Said> said;
    double ticked_s = 0, heartbeat_s = 0, looked_s = 0;
    bool joins = fleet.joins_s > 0, leaves = fleet.leaves_s > 0, pauses = fleet.paused_s > 0,
         resumes = fleet.resumed_s > 0;
    const auto at = [this](bool* due, double when_s) { return *due && now_s_ >= when_s && !(*due = false); };
    while (core_.FindJob("job")->state != proto::JOB_DONE) {
      now_s_ = std::min(NextAnswer(), ticked_s + kTick_s);
      if (at(&joins, fleet.joins_s)) Join();
      if (at(&leaves, fleet.leaves_s)) Leave();
      if (at(&pauses, fleet.paused_s)) Do(PauseJob{"job", ""});
      if (at(&resumes, fleet.resumed_s)) Do(ResumeJob{"job", ""});
      if (now_s_ >= ticked_s + kTick_s) {
        ticked_s = now_s_;
        Do(Tick{});
        if (now_s_ >= heartbeat_s + kHeartbeat_s) {
          heartbeat_s = now_s_;
          Heartbeat();
        }
        if (now_s_ >= looked_s + kLook_s && core_.FindJob("job")->Running()) {
          looked_s = now_s_;
          const wire::JobInfo info = *core_.Find("job");
          said.push_back({now_s_, info.eta_s(), info.eta_least_s(), info.eta_most_s(), 0});
        }
      }
      AnswerWhatIsDone();
      if (core_.FindJob("job")->state == proto::JOB_FAILED)
        throw InputError("the replayed job failed: " + core_.FindJob("job")->reason);
    }
    for (Said& one : said) one.true_s = now_s_ - one.at_s;
    return said;
  }

 private:
  struct Queue {
    std::deque<wire::TaskKey> tasks;
    double done_s = 0;  // when the first will be
  };

  static CoreOptions OptionsOfTest() {
    CoreOptions options;
    options.build.set_version("replay");
    return options;
  }

  void Join() {
    wire::Hello hello;
    hello.set_protocol(CoreOptions().protocol);
    *hello.mutable_build() = OptionsOfTest().build;
    hello.set_slots(2);
    const std::string peer = "w" + std::to_string(joined_++);
    queues_[peer];
    Do(WorkerHello{peer, hello});
  }

  void Leave() {
    const std::string peer = queues_.rbegin()->first;
    queues_.erase(peer);
    Do(WorkerLost{peer});
  }

  void Do(const Event& event) {
    for (const Action& action : core_.Handle(event, now_s_)) {
      if (const auto* persist = std::get_if<Persist>(&action)) {
        saved_.push_back(PersistDone{persist->checkpoint.job_id(), persist->checkpoint.number()});
      } else if (const auto* send = std::get_if<Send>(&action)) {
        if (send->message.has_assign()) Take(send->peer, send->message.assign().key());
        if (send->message.has_cancel()) Drop(send->peer, send->message.cancel().key());
      }
    }
    while (!saved_.empty()) {
      const PersistDone done = saved_.front();
      saved_.pop_front();
      Do(done);
    }
  }

  double SecondsOf(const wire::TaskKey& key) const {
    if (key.kind() == wire::TaskKey::START) return trace_.start_s;
    const Trace::Round& round = trace_.rounds.at(key.round());
    return key.kind() == wire::TaskKey::ADVANCE ? round.advance_s : round.task_s.at(key.task());
  }

  void Begin(Queue& queue) const { queue.done_s = now_s_ + kMessage_s + SecondsOf(queue.tasks.front()); }

  void Take(const std::string& peer, const wire::TaskKey& key) {
    const auto queue = queues_.find(peer);
    if (queue == queues_.end()) return;
    queue->second.tasks.push_back(key);
    if (queue->second.tasks.size() == 1) Begin(queue->second);
  }

  void Drop(const std::string& peer, const wire::TaskKey& key) {
    const auto found = queues_.find(peer);
    if (found == queues_.end()) return;
    Queue& queue = found->second;
    const bool runs = !queue.tasks.empty() && SameAttempt(queue.tasks.front(), key);
    std::erase_if(queue.tasks, [&](const wire::TaskKey& other) { return SameAttempt(other, key); });
    if (runs && !queue.tasks.empty()) Begin(queue);
  }

  double NextAnswer() const {
    double next_s = HUGE_VAL;
    for (const auto& [peer, queue] : queues_)
      if (!queue.tasks.empty()) next_s = std::min(next_s, queue.done_s);
    return next_s;
  }

  void AnswerWhatIsDone() {
    for (bool more = true; more;) {
      more = false;
      for (auto& [peer, queue] : queues_) {
        if (queue.tasks.empty() || queue.done_s > now_s_) continue;
        const wire::TaskKey key = queue.tasks.front();
        queue.tasks.pop_front();
        if (!queue.tasks.empty()) Begin(queue);
        Answer(peer, key);
        more = true;
        break;
      }
    }
  }

  void Answer(const std::string& peer, const wire::TaskKey& key) {
    TaskDone event{peer, {}, {}};
    *event.done.mutable_key() = key;
    if (key.kind() == wire::TaskKey::RUN) {
      const Hash partial = H(++answers_);
      event.done.set_partial(partial.Binary());
      event.blobs = {partial};
    } else {
      const std::uint64_t next = key.kind() == wire::TaskKey::START ? 0 : key.round() + 1;
      if (next < trace_.rounds.size()) {
        *event.done.mutable_step() = trace_.rounds[next].step;
      } else {
        event.done.mutable_step()->set_result(H(1).Binary());
        event.blobs = {H(1)};
      }
    }
    Do(event);
  }

  void Heartbeat() {
    for (const auto& [peer, queue] : std::map(queues_)) {
      wire::Heartbeat heartbeat;
      for (const wire::TaskKey& key : queue.tasks) {
        *heartbeat.add_tasks() = key;
        heartbeat.add_ticks(static_cast<std::uint64_t>(now_s_ * 10));
      }
      Do(WorkerHeartbeat{peer, heartbeat});
    }
  }

  const Trace& trace_;
  Core core_;
  double now_s_ = 0;
  int joined_ = 0;
  std::uint64_t answers_ = 1000;
  std::map<std::string, Queue> queues_;
  std::deque<PersistDone> saved_;
};

// Words of a line.
class Line {
 public:
  Line(const std::string& path, int number, const std::string& text)
      : where_(path + ", line " + std::to_string(number)), words_(text) {}
  template <class T>
  T Next() {
    const std::optional<T> value = Maybe<T>();
    if (!value) throw InputError(where_ + ": a word is missing, or is no number");
    return *value;
  }
  template <class T>
  std::optional<T> Maybe() {
    T value{};
    if (words_ >> value) return value;
    return std::nullopt;
  }
  [[noreturn]] void Refuse(const std::string& word) const {
    throw InputError(where_ + ": '" + word + "' is not understood");
  }

 private:
  std::string where_;
  std::istringstream words_;
};

void AddTask(Line line, Trace::Round* round) {
  proto::Task& task = *round->step.add_tasks();
  task.set_index(static_cast<std::uint32_t>(round->step.tasks_size() - 1));
  task.set_kind(line.Next<std::string>());
  task.set_cost(line.Next<std::uint64_t>());
  round->task_s.push_back(line.Next<double>());
  while (const std::optional<std::uint32_t> read = line.Maybe<std::uint32_t>())
    task.add_inputs()->set_task(*read);
}

}  // namespace

Trace ReadTrace(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be read");
  Trace trace;
  int number = 0, times = 1;
  for (std::string text; std::getline(file, text);) {
    Line line(path, ++number, text);
    const std::string word = line.Next<std::string>(), rest = text.substr(word.size());
    if (word == "#") continue;
    if (word == "start") {
      trace.start_s = line.Next<double>();
    } else if (word == "round") {
      Trace::Round& round = trace.rounds.emplace_back();
      round.step.set_advance_cost(line.Next<double>());
      round.advance_s = line.Next<double>();
    } else if (trace.rounds.empty()) {
      line.Refuse(word);
    } else if (word == "later") {
      proto::Phase& phase = *trace.rounds.back().step.add_later();
      phase.set_rounds(line.Next<double>());
      phase.set_cost(line.Next<double>());
      phase.set_width(line.Next<double>());
      if (const std::optional<double> least = line.Maybe<double>()) {
        phase.set_least(*least);
        phase.set_most(line.Next<double>());
      }
    } else if (word == "times") {
      times = line.Next<int>();
    } else if (word == "task") {
      for (int copy = 0; copy < times; ++copy) AddTask(Line(path, number, rest), &trace.rounds.back());
    } else {
      line.Refuse(word);
    }
  }
  return trace;
}

std::vector<Said> Replay(const Trace& trace, const Fleet& fleet) { return Replayer(trace, fleet).Run(fleet); }

double Nearest(const Said& said) {
  return said.IsSpan() ? std::clamp(said.true_s, said.least_s, said.most_s) : said.said_s;
}

bool IsNear(const Said& said) {
  if (said.said_s <= 0) return false;
  const double said_s = Nearest(said);
  if (std::abs(said_s - said.true_s) <= kSlack_s) return true;
  return said_s <= kMostOff * said.true_s && said.true_s <= kMostOff * said_s;
}

}  // namespace cairn::eta
