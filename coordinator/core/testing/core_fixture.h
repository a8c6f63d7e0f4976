// A fixture for tests of the core: feeds it events, keeps what comes out, and plays workers by hand.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "coordinator/core/core.h"
#include "coordinator/core/testing/test_job.h"

namespace cairn::coordinator {

class CoreFixture {
 public:
  explicit CoreFixture(const CoreOptions& options = {}) : core(OfTestBuild(options)) {}
  static CoreOptions OfTestBuild(CoreOptions options) {
    if (options.build.version().empty()) options.build = TestBuild();
    return options;
  }

  Core core;
  double now_s = 0;
  std::vector<Action> actions;  // of the last event
  std::vector<std::string> alarms;
  std::vector<std::string> said;  // of the other reports

  void Do(const Event& event) {
    actions = core.Handle(event, now_s);
    for (const Action& action : actions) {
      if (const auto* report = std::get_if<Report>(&action))
        (report->level == Report::kAlarm ? alarms : said).push_back(report->text);
      if (const auto* send = std::get_if<Send>(&action))
        if (send->message.has_assign()) assigned.push_back({send->peer, send->message.assign()});
    }
  }
  void Advance(double seconds) {
    now_s += seconds;
    Do(Tick{});
  }
  // With a tick a second, as of one that does not stand still.
  void Pass(double seconds) {
    for (; seconds > 1; --seconds) Advance(1);
    Advance(seconds);
  }
  // `process`: 0 where it is of no matter which it is.
  void Join(const std::string& peer, std::uint32_t slots = 1, const std::string& version = "1",
            std::uint64_t process = 0) {
    wire::Hello hello;
    hello.set_protocol(3);
    *hello.mutable_build() = TestBuild(version);
    hello.set_host("host-" + peer);
    hello.set_slots(slots);
    hello.set_process(process);
    Do(WorkerHello{peer, hello});
  }
  void Submit(const std::string& id = "a", const proto::Job& job = TestJob()) { Do(SubmitJob{id, job, {}}); }

  struct Assigned {
    std::string peer;
    wire::Assign assign;
  };
  std::vector<Assigned> assigned;  // not yet looked at

  // The next task dispatched, which there must be.
  Assigned Next() {
    if (assigned.empty()) {
      ADD_FAILURE() << "nothing was assigned";
      return {};
    }
    const Assigned next = assigned.front();
    assigned.erase(assigned.begin());
    return next;
  }
  void AnswerRun(const Assigned& task, const Hash& partial) {
    wire::Done done;
    *done.mutable_key() = task.assign.key();
    done.set_partial(partial.Binary());
    Do(TaskDone{task.peer, done, {partial}});
  }
  void AnswerPlan(const Assigned& task, const proto::Step& step, const std::vector<Hash>& blobs = {}) {
    wire::Done done;
    *done.mutable_key() = task.assign.key();
    *done.mutable_step() = step;
    Do(TaskDone{task.peer, done, blobs});
  }
  void AnswerResult(const Assigned& task, const Hash& result) {
    proto::Step step;
    step.set_result(result.Binary());
    AnswerPlan(task, step, {result});
  }
  void Fail(const Assigned& task, const std::string& message, bool input_error = false) {
    wire::Failed failed;
    *failed.mutable_key() = task.assign.key();
    failed.set_message(message);
    failed.set_input_error(input_error);
    Do(TaskFailed{task.peer, failed});
  }
  // A heartbeat that lists `tasks`, all with the same tick count.
  void Heartbeat(const std::string& peer, const std::vector<Assigned>& tasks = {}, std::uint64_t ticks = 0) {
    wire::Heartbeat heartbeat;
    for (const Assigned& task : tasks) {
      *heartbeat.add_tasks() = task.assign.key();
      heartbeat.add_ticks(ticks);
    }
    Do(WorkerHeartbeat{peer, heartbeat});
  }
  wire::JobInfo Info(const std::string& id = "a") const { return core.Find(id).value_or(wire::JobInfo()); }

  template <class T>
  std::vector<T> All() const {
    std::vector<T> found;
    for (const Action& action : actions)
      if (const T* one = std::get_if<T>(&action)) found.push_back(*one);
    return found;
  }
  // Messages of the last event that `has` is true of.
  std::vector<Send> Sent(bool (wire::Envelope::*has)() const) const {
    std::vector<Send> found;
    for (const Send& send : All<Send>())
      if ((send.message.*has)()) found.push_back(send);
    return found;
  }
};

// Carries a job with the worker `w` of so many slots to its first round of `tasks` tasks.
inline void Begin(CoreFixture& fixture, int tasks, std::uint32_t slots = 1) {
  fixture.Submit();
  fixture.Do(PersistDone{"a", 1});
  fixture.Join("w", slots);
  fixture.AnswerPlan(fixture.Next(), TestStep(tasks));
}

// The worker sends heartbeats for longer than `hung_s`, but its task does not move.
inline void HeartbeatUnmoved(CoreFixture& fixture, const CoreFixture::Assigned& task) {
  for (int i = 0; i < 65; ++i) {
    fixture.Heartbeat(task.peer, {task}, 3);
    fixture.Advance(1);
  }
}

}  // namespace cairn::coordinator
