#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <thread>

#include "coordinator/cli/commands/end_hook.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/core/job.h"
#include "coordinator/server/service.h"
#include "schema/process_limits.h"

namespace cairn::cli {
namespace {

struct CoordinatorArguments {
  coordinator::ServiceOptions service;
  std::string on_end, key_limits;
};

wire::KeyLimits DefaultLimits(const std::string& text) {
  const Result<wire::KeyLimits> limits = wire::ParseLimits(text);
  if (!limits.ok()) throw InputError("--key-limits: " + limits.status().message());
  if (limits.value().until_s != 0 || limits.value().connections != 0)
    throw InputError("--key-limits: until and connections are said of each key by itself (cairn keys allow)");
  return limits.value();
}

// That it cannot be run shows now, not when the first job has ended.
std::string HookProgram(const std::string& path) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::absolute(path, error);
  if (!std::filesystem::is_regular_file(program, error) || ::access(program.c_str(), X_OK) != 0)
    throw InputError("--on-end: '" + path + "' is no program that can be run; say its whole path");
  return program.string();
}

int Serve(const CoordinatorArguments& options, const Invocation& call) {
  Check(PrepareProcess({.files = 48, .file_bytes = 64 << 20, .memory_bytes = 512 << 20, .threads = 9}));
  coordinator::ServiceOptions service = options.service;
  service.key_limits = DefaultLimits(options.key_limits);
  if (service.store_dir.empty()) service.store_dir = HomeFolder() + "/store";
  if (service.listen.empty()) service.listen = DefaultEndpoint();
  if (service.keys_dir.empty() && service.listen.starts_with("tcp://")) {
    service.keys_dir = ConfigFolder();
    DefaultKey("coordinator.key");
  }
  Invocation talkative = call;
  talkative.verbose = true;       // a service's log is all that there is to see of it
  std::signal(SIGPIPE, SIG_IGN);  // who read it may go; the service stays
  Console console(talkative);
  constexpr double kHookLimit_s = 60;
  std::optional<EndHook> hook;
  if (!options.on_end.empty()) {
    hook.emplace(HookProgram(options.on_end), kHookLimit_s, console.Sink());
    service.job_ended = [&hook](const wire::JobInfo& job) { hook->JobEnded(job); };
  }
  const std::atomic<bool>& stop = StopOnSignals();
  Check(coordinator::Serve(service, console.Sink(), stop));
  // One that was told to end does not wait, one that ends by itself does.
  while (hook && !stop && !hook->Idle()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return kExitDone;
}

}  // namespace

void AddCoordinator(Command app, Invocation& call) {
  Command command;
  const auto options = AddCommand<CoordinatorArguments>(
      app, call, "coordinator", "Serves jobs to workers on many machines, until Ctrl-C",
      "cairn coordinator --store-gb 200 --keep-days 30 &\n  cairn worker & cairn worker &\n  "
      "cairn submit job.yaml && cairn watch",
      Serve, &command);
  coordinator::ServiceOptions& service = options->service;
  command.Add("--store", service.store_dir, "Folder of jobs, checkpoints and results (~/.cairn/store)");
  command.Add("--listen", service.listen,
              "ipc://PATH in a folder of mode 0700 (~/.cairn), or tcp://HOST:PORT, which needs keys");
  command
      .Add("--keys", service.keys_dir,
           "Folder of coordinator.key and the list of allowed keys (tcp: ~/.config/cairn)")
      .ExistingFolder();
  command.Add(
      "--key-limits", options->key_limits,
      "Of keys of which the list says nothing else, but administrators': requests=N a second, jobs=N that "
      "have not ended, inputs-mb=N of such jobs, memory-mb=N of a task, with commas (no limits)");
  command.Add("--max-connections", service.sockets.connections.connections, "At a time")
      .Within(1, 1'000'000)
      .ShowDefault();
  command
      .AddTaking<std::uint64_t>(
          "--max-message-mb",
          [&service](const std::size_t& mb) {
            service.sockets.limits.message_bytes = mb << 20;
            service.sockets.connections.unread_bytes = mb << 21;
          },
          "Largest message, blobs included (4096)")
      .Within(1, 1'000'000);
  command
      .AddTaking<std::uint64_t>(
          "--unread-mb", [&service](const std::uint64_t& mb) { service.sent_bytes = mb << 20; },
          "Results and inputs that clients have yet to read, at most; a quarter of it for one key (256)")
      .Within(1, 1'000'000);
  command
      .AddTaking<std::uint64_t>(
          "--memory-mb", [&service](const std::uint64_t& mb) { service.memory_bytes = mb << 20; },
          "What tasks have computed and others need is in memory up to this, and on disk alone beyond it (a "
          "quarter of what the coordinator may have, 4096 at most)")
      .Within(1, 1'000'000);
  command.Add("--checkpoint-interval", service.checkpoint_interval_s, "Seconds between checkpoints of a job")
      .Within(0.0, 3600.0)
      .ShowDefault();
  command
      .Add("--checkpoint-rounds", service.checkpoint_rounds,
           "A checkpoint of a job every so many of its rounds, instead of by seconds (0: by seconds)")
      .Within(std::uint64_t{0}, std::uint64_t{1'000'000'000});
  command
      .AddTaking<double>(
          "--store-gb",
          [&service](const double& gb) { service.store_limit_bytes = static_cast<std::uint64_t>(gb * 1e9); },
          "What the store may take on disk; a job that would take more is paused (no limit)")
      .Within(0.001, 1e9);
  command
      .AddTaking<double>(
          "--keep-days", [&service](const double& days) { service.keep_s = days * 86400; },
          "Delete jobs, results too, that have ended for longer; counted while a coordinator runs (for ever)")
      .Within(0.0001, 1e6);
  command
      .Add("--task-time-s", service.task_time_s,
           "Limit on a task's run time, where the job file says nothing (0: none)")
      .Within(0.0, 1e9)
      .ShowDefault();
  command
      .Add("--task-memory-mb", service.task_memory_mb,
           "Limit on the memory that a task may take, where the job file says nothing (0: none)")
      .Within(std::uint64_t{0}, coordinator::kMostTaskMemory_mb)
      .ShowDefault();
  command.AddFlag(
      "--take-over", service.take_over,
      "Serve the store also where another machine's coordinator did not give it back; that one writes "
      "nothing more there");
  command.AddFlag("--drain", service.drain,
                  "Take no new jobs, finish those that are there, and end; what is paused stays paused");
  command.Add(
      "--on-end", options->on_end,
      "A program that is run when a job has ended, with the job as JSON on its input, as `cairn status JOB "
      "--json` prints it; for at most a minute, one after the other (none)");
  command.Add("--metrics", service.metrics,
              "Show metrics for Prometheus, /healthz and /readyz over HTTP at ADDRESS:PORT, or PORT of this "
              "machine alone (nowhere)");
}

}  // namespace cairn::cli
