// How many events a second the coordinator's core handles, with no socket, disk or clock around it: one round
// of many short tasks, workers that answer in turn, a tick now and then. Prints a JSON line.
//
//   core_rate [TASKS [WORKERS [SLOTS]]]      # 100000 tasks, 1000 workers, 4 slots each
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>

#include "coordinator/core/core.h"
#include "coordinator/core/testing/test_job.h"

namespace cairn::bench {
namespace {

using namespace coordinator;  // NOLINT: events and actions, all over this file

proto::Step StepOf(int tasks) {
  proto::Step step = TestStep(tasks, "", H(0));
  for (proto::Task& task : *step.mutable_tasks()) task.set_cost(1);
  return step;
}

class Run {
 public:
  Run(std::uint32_t tasks, std::uint32_t workers, std::uint32_t slots) : tasks_(tasks) {
    for (std::uint32_t i = 0; i < workers; ++i) {
      wire::Hello hello;
      hello.set_protocol(CoreOptions().protocol);
      hello.set_slots(slots);
      Do(WorkerHello{Peer(i), hello});
    }
    Do(SubmitJob{"job", TestJob(1, H(0)), {H(0)}});
  }

  // Until the job's last task is answered; returns how many events that took.
  std::uint64_t UntilDone() {
    while (!assigned_.empty()) {
      const Given next = std::move(assigned_.front());
      assigned_.pop_front();
      Answer(next);
      if (events_ % kEventsATick == 0) Do(Tick{});
    }
    return events_;
  }
  bool Ended() const { return core_.FindJob("job")->AllStagesDone(); }

 private:
  struct Given {
    std::string peer;
    wire::TaskKey key;
  };
  static constexpr std::uint64_t kEventsATick = 5000;
  static constexpr double kEvent_s = 1e-5;

  static std::string Peer(std::uint32_t number) { return "worker-" + std::to_string(number); }

  void Answer(const Given& given) {
    wire::Done done;
    *done.mutable_key() = given.key;
    if (given.key.kind() == wire::TaskKey::RUN) {
      const Hash partial = H(1 + given.key.task());
      done.set_partial(partial.Binary());
      Do(TaskDone{given.peer, done, {partial}});
      return;
    }
    if (given.key.kind() == wire::TaskKey::START) {
      *done.mutable_step() = StepOf(static_cast<int>(tasks_));
      Do(TaskDone{given.peer, done, {}});
      return;
    }
    const Hash result = H(~0ull);
    done.mutable_step()->set_result(result.Binary());
    Do(TaskDone{given.peer, done, {result}});
  }

  void Do(const Event& event) {
    ++events_;
    now_s_ += kEvent_s;
    for (const Action& action : core_.Handle(event, now_s_))
      if (const auto* send = std::get_if<Send>(&action); send != nullptr && send->message.has_assign())
        assigned_.push_back({send->peer, send->message.assign().key()});
  }

  std::uint32_t tasks_;
  Core core_{CoreOptions()};
  double now_s_ = 0;
  std::uint64_t events_ = 0;
  std::deque<Given> assigned_;
};

int Main(int argc, char** argv) {
  const auto argument = [&](int i, std::uint32_t otherwise) {
    return argc > i ? static_cast<std::uint32_t>(std::strtoul(argv[i], nullptr, 10)) : otherwise;
  };
  const std::uint32_t tasks = argument(1, 100000), workers = argument(2, 1000), slots = argument(3, 4);
  Run run(tasks, workers, slots);
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t events = run.UntilDone();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf(
      "{\"tasks\": %u, \"workers\": %u, \"slots\": %u, \"done\": %s, \"seconds\": %.3f, \"events_per_s\": "
      "%.0f}\n",
      tasks, workers, slots, run.Ended() ? "true" : "false", seconds, static_cast<double>(events) / seconds);
  return run.Ended() ? 0 : 1;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) { return cairn::bench::Main(argc, argv); }
