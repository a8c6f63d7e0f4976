// What handing out a task costs, end to end: a coordinator process with its store, workers in processes of
// their own, real sockets. Tasks do nothing but note the time at which they ran, in memory that all processes
// share, so that what is measured is all between two tasks. Prints a JSON line; dispatch.sh runs it beside
// dask.distributed and prints the ratios:
//
//   tests/bench/dispatch.sh                      # all of it
//   dispatch_bench --tasks 50000 --workers 2     # one row
//   dispatch_bench --tasks 2000 --chain          # each task waits for the one before: a round trip a task
//
// Many workers: tests/swarm.
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <list>
#include <nlohmann/json.hpp>
#include <thread>

#include "coordinator/client.h"
#include "coordinator/server/service.h"
#include "schema/build_info.h"
#include "schema/numerics.h"
#include "schema/wire/testing/private_folder.h"
#include "worker/worker.h"
#include "worker/zmq_transport.h"

namespace cairn::bench {
namespace {

namespace fs = std::filesystem;

std::int64_t NowNs() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

// When each task ran, by its index; shared with the workers' processes.
class SharedTimes {
 public:
  explicit SharedTimes(int tasks) : size_(static_cast<std::size_t>(tasks)) {
    void* memory = ::mmap(nullptr, size_ * sizeof(std::int64_t), PROT_READ | PROT_WRITE,
                          MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CAIRN_DEMAND(memory != MAP_FAILED, "no memory");
    times_ns_ = static_cast<std::int64_t*>(memory);
  }
  void Note(std::uint32_t task) const { times_ns_[task] = NowNs(); }
  std::vector<std::int64_t> Sorted() const {
    std::vector<std::int64_t> times(times_ns_, times_ns_ + size_);
    std::sort(times.begin(), times.end());
    return times;
  }

 private:
  std::size_t size_;
  std::int64_t* times_ns_;
};

Blob PartialOf(std::uint32_t task) {
  Blob blob;
  blob.PutScalar<std::int64_t>("task", task);
  return blob;
}

// `tasks` tasks in one round; the result counts the partials.
class Empty : public Pipeline {
 public:
  Empty(const proto::Stage& stage, const SharedTimes& times)
      : tasks_(stage.options().at("tasks").i()),
        chain_(stage.options().at("chain").i() != 0),
        times_(times) {}

  Step Start(const Inputs&) const override { return PlanRound(); }
  Step PlanRound() const {
    Step step;
    for (std::uint32_t i = 0; i < tasks_; ++i) {
      Task& task = *step.plan.add_tasks();
      task.set_index(i);
      if (!chain_ || i == 0) continue;
      proto::InputRef& before = *task.add_inputs();
      before.set_name("before");
      before.set_task(i - 1);
    }
    return step;
  }
  Blob Run(const Task& task, const Inputs&, Progress&) const override {
    times_.Note(task.index());
    return PartialOf(task.index());
  }
  Step Advance(const State&, Partials& partials, const Inputs&) const override {
    for (std::size_t i = 0; i < partials.size(); ++i)
      CAIRN_DEMAND(partials.Get(i)->Scalar<std::int64_t>("task") == static_cast<std::int64_t>(i),
                   "not in task order");
    return ResultOf(static_cast<std::int64_t>(partials.size()));
  }
  static Step ResultOf(std::int64_t partials) {
    Blob result;
    result.PutScalar("partials", partials);
    Step step;
    step.plan.set_result(step.Share(std::move(result)));
    return step;
  }

 private:
  const std::int64_t tasks_;
  const bool chain_;
  const SharedTimes& times_;
};

struct Arguments {
  int tasks = 50'000;
  int workers = 2;
  int slots = 64;
  bool chain = false;
};

wire::Hello HelloOf(int slots) {
  wire::Hello hello;
  hello.set_protocol(wire::kProtocol);
  *hello.mutable_build() = ThisBuild();
  hello.set_host("here");
  hello.set_pid(::getpid());
  hello.set_slots(static_cast<std::uint32_t>(slots));
  return hello;
}

int Work(const std::string& endpoint, int slots, const SharedTimes& times) {
  std::atomic<bool> stop{false};
  const std::unique_ptr<worker::ZmqTransport> transport = worker::ZmqTransport::Connect(endpoint).value();
  worker::WorkerOptions options;
  options.session.hello = HelloOf(slots);
  options.session.exit_on_leave = true;
  const auto make = [&times](const proto::Stage& stage, std::uint64_t) {
    return std::make_unique<Empty>(stage, times);
  };
  return worker::RunWorker(*transport, make, options, stop);
}

// Runs `work` in a process of its own, which ends with the object.
class Child {
 public:
  explicit Child(const std::function<int()>& work) : pid_(::fork()) {
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::_Exit(work());
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  // The most memory it ever had, in MiB.
  double PeakMib() const {
    std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
    return 0;
  }

 private:
  const pid_t pid_;
};

int Coordinate(const std::string& store, const std::string& endpoint) {
  const std::atomic<bool> stop{false};
  coordinator::ServiceOptions options;
  options.store_dir = store;
  options.listen = endpoint;
  const auto log = [](coordinator::Severity, const std::string& line) {
    std::fprintf(stderr, "%s\n", line.c_str());
  };
  return coordinator::Serve(options, log, stop).ok() ? 0 : 1;
}

proto::Job MakeJob(const Arguments& a) {
  proto::Job job;
  job.set_name("empty");
  proto::Stage& stage = *job.add_stages();
  stage.set_name("empty");
  stage.set_pipeline("empty");
  (*stage.mutable_options())["tasks"].set_i(a.tasks);
  (*stage.mutable_options())["chain"].set_i(a.chain ? 1 : 0);
  return job;
}

void AwaitWorkers(coordinator::Client& client, unsigned count) {
  while (true) {
    const auto list = client.List();
    if (list.ok() && list.value().workers >= count) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

void RunJob(coordinator::Client& client, const Arguments& a) {
  const wire::JobInfo job = client.Submit(MakeJob(a), std::map<std::string, BlobPtr>{}).value();
  while (true) {
    const wire::JobInfo info = client.Info(job.id()).value();
    if (info.state() == "done") break;
    CAIRN_DEMAND(info.state() == "running" || info.state() == "queued", info.reason());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const auto results = client.Results(job.id()).value();
  CAIRN_DEMAND(results.at("empty")->Scalar<std::int64_t>("partials") == a.tasks, "partials are missing");
}

void Main(const Arguments& a) {
  const SharedTimes shared(a.tasks);
  const wire::PrivateFolder folder;
  const std::string endpoint = folder.Ipc("hub");
  const Child coordinator([&] { return Coordinate((folder.path() / "store").string(), endpoint); });
  std::list<Child> workers;
  for (int i = 0; i < a.workers; ++i) workers.emplace_back([&] { return Work(endpoint, a.slots, shared); });
  coordinator::Client client =
      coordinator::Client::Connect({.endpoint = endpoint, .security = {}, .timeout_s = 60}).value();
  AwaitWorkers(client, static_cast<unsigned>(a.workers));
  const std::int64_t begin_ns = NowNs();
  RunJob(client, a);
  const double job_s = static_cast<double>(NowNs() - begin_ns) * 1e-9;
  const std::vector<std::int64_t> times = shared.Sorted();
  std::vector<std::int64_t> gaps;
  for (std::size_t i = 1; i < times.size(); ++i) gaps.push_back(times[i] - times[i - 1]);
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  const double span_s = static_cast<double>(times.back() - times.front()) * 1e-9;
  std::puts(nlohmann::json{{"tasks", a.tasks},
                           {"workers", a.workers},
                           {"tasks_per_s", (a.tasks - 1) / span_s},
                           {"median_gap_ms", static_cast<double>(gaps[gaps.size() / 2]) * 1e-6},
                           {"job_s", job_s},
                           {"coordinator_peak_mib", coordinator.PeakMib()}}
                .dump()
                .c_str());
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  cairn::bench::Arguments a;
  CLI::App app("What handing out a task costs");
  app.add_option("--tasks", a.tasks)->check(CLI::Range(2, 10'000'000));
  app.add_option("--workers", a.workers)->check(CLI::Range(1, 64));
  app.add_option("--slots", a.slots, "tasks in flight to a worker")->check(CLI::Range(1, 1000));
  app.add_flag("--chain", a.chain, "each task waits for the one before");
  CLI11_PARSE(app, argc, argv);
  cairn::FixNumericsOfProcess();
  cairn::FixNumericsOfThread();
  cairn::bench::Main(a);
}
