#include <csignal>

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
};

int Serve(const CoordinatorArguments& options, const Invocation& call) {
  Check(PrepareProcess({.files = 48, .file_bytes = 64 << 20, .memory_bytes = 512 << 20, .threads = 9}));
  coordinator::ServiceOptions service = options.service;
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
  Check(coordinator::Serve(service, console.Sink(), StopOnSignals()));
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
  command.Add("--metrics", service.metrics,
              "Show metrics for Prometheus, /healthz and /readyz over HTTP at ADDRESS:PORT, or PORT of this "
              "machine alone (nowhere)");
}

}  // namespace cairn::cli
