// handover [--kills N]: how long it takes until the task of a worker that is killed runs elsewhere. Prints
// the times from kill -9 to the moment at which another process begins the same task.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>
#include <vector>

#include "coordinator/client.h"
#include "schema/rng.h"
#include "tests/conformance/cases.h"
#include "tests/faults/process.h"

namespace cairn::faults {
namespace {

struct Begun {
  long long ms = 0;
  pid_t pid = 0;
  std::string task;
};

std::vector<Begun> ReadTrace(const std::filesystem::path& path) {
  std::vector<Begun> all;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    Begun begun;
    std::istringstream words(line);
    words >> begun.ms >> begun.pid;
    std::getline(words, begun.task);
    all.push_back(begun);
  }
  return all;
}

long long NowMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
void Sleep(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

// The task that a process has assigned, once it has one that is new.
Begun AwaitTask(const std::filesystem::path& trace, pid_t pid, long long after_ms) {
  while (true) {
    for (const Begun& begun : ReadTrace(trace))
      if (begun.pid == pid && begun.ms > after_ms) return begun;
    Sleep(5);
  }
}

// Milliseconds from the kill until another process begins `task`.
long long AwaitElsewhere(const std::filesystem::path& trace, const Begun& task, long long killed_ms) {
  while (true) {
    for (const Begun& begun : ReadTrace(trace))
      if (begun.pid != task.pid && begun.ms >= killed_ms && begun.task == task.task)
        return begun.ms - killed_ms;
    Sleep(5);
  }
}

int Measure(int kills) {
  std::string folder = (std::filesystem::temp_directory_path() / "cairn-handover-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return 1;
  const std::filesystem::path dir = folder, trace = dir / "trace";
  ::setenv("CAIRN_TASK_MS", "400", 1);
  ::setenv("CAIRN_TRACE_FILE", trace.c_str(), 1);
  const std::string endpoint = "ipc://" + (dir / "hub").string();
  const Process coordinator(
      {CAIRN_PROGRAM, "coordinator", "--store", (dir / "store").string(), "--listen", endpoint},
      dir / "coordinator.log");
  const auto start = [&] {
    return Process({CAIRN_FAULTS_WORKER, "--connect", endpoint}, dir / "worker.log");
  };
  std::vector<Process> workers;
  for (int i = 0; i < 3; ++i) workers.push_back(start());
  conformance::Case c = conformance::AllCases().back();  // the toy
  (*c.stage.mutable_options())["rounds"].set_i(100000);
  (*c.stage.mutable_options())["slices"].set_i(12);
  auto client = coordinator::Client::Connect({.endpoint = endpoint, .security = {}, .timeout_s = 30}).value();
  if (const auto job = client.Submit(conformance::JobOf(c), c.inputs); !job.ok())
    return std::fprintf(stderr, "%s\n", job.status().message().c_str()), 1;
  std::vector<long long> times;
  Rng rng(1);
  for (int i = 0; i < kills; ++i) {
    Process& victim = workers[rng.Below(workers.size())];
    const Begun task = AwaitTask(trace, victim.pid(), NowMs());
    Sleep(static_cast<int>(rng.Below(300)));
    const long long killed_ms = NowMs();
    victim.Kill();
    times.push_back(AwaitElsewhere(trace, task, killed_ms));
    victim = start();
    std::printf("%lld ms\n", times.back());
  }
  std::ranges::sort(times);
  std::printf("%d kills: median %lld ms, most %lld ms\n", kills, times[times.size() / 2], times.back());
  workers.clear();
  std::filesystem::remove_all(dir);
  return 0;
}

}  // namespace
}  // namespace cairn::faults

int main(int argc, char** argv) {
  int kills = 20;
  CLI::App app("Measures how soon a killed worker's task runs elsewhere", "handover");
  app.add_option("--kills", kills)->capture_default_str()->check(CLI::Range(1, 10000));
  CLI11_PARSE(app, argc, argv);
  return cairn::faults::Measure(kills);
}
