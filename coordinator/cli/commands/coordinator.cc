#include <cstdio>

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
  Check(PrepareProcess({.files = 48, .file_bytes = 64 << 20, .memory_bytes = 512 << 20}));
  coordinator::ServiceOptions service = options.service;
  if (service.store_dir.empty()) service.store_dir = HomeFolder() + "/store";
  if (service.listen.empty()) service.listen = DefaultEndpoint();
  if (service.keys_dir.empty() && service.listen.starts_with("tcp://")) {
    service.keys_dir = ConfigFolder();
    DefaultKey("coordinator.key");
  }
  Invocation talkative = call;
  talkative.verbose = true;  // a service's log is all that there is to see of it
  Console console(talkative);
  Check(coordinator::Serve(service, console.Sink(), StopOnSignals()));
  return kExitDone;
}

}  // namespace

void AddCoordinator(CLI::App& app, Invocation& call) {
  CLI::App* command = nullptr;
  const auto options = AddCommand<CoordinatorArguments>(
      app, call, "coordinator", "Serves jobs to workers on many machines, until Ctrl-C",
      "cairn coordinator --store-gb 200 --keep-days 30 &\n  cairn worker & cairn worker &\n  "
      "cairn submit job.yaml && cairn watch",
      Serve, &command);
  coordinator::ServiceOptions& service = options->service;
  command->add_option("--store", service.store_dir,
                      "Folder of jobs, checkpoints and results (~/.cairn/store)");
  command->add_option("--listen", service.listen,
                      "ipc://PATH in a folder of mode 0700 (~/.cairn), or tcp://HOST:PORT, which needs keys");
  command
      ->add_option("--keys", service.keys_dir,
                   "Folder of coordinator.key and the list of allowed keys (tcp: ~/.config/cairn)")
      ->check(CLI::ExistingDirectory);
  command->add_option("--max-connections", service.sockets.connections.connections, "At a time")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command
      ->add_option_function<std::size_t>(
          "--max-message-mb",
          [&service](const std::size_t& mb) {
            service.sockets.limits.message_bytes = mb << 20;
            service.sockets.connections.unread_bytes = mb << 21;
          },
          "Largest message, blobs included (4096)")
      ->check(CLI::Range(1, 1'000'000));
  command
      ->add_option("--checkpoint-interval", service.checkpoint_interval_s,
                   "Seconds between checkpoints of a job")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command
      ->add_option("--checkpoint-rounds", service.checkpoint_rounds,
                   "A checkpoint of a job every so many of its rounds, instead of by seconds (0: by seconds)")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1'000'000'000}));
  command
      ->add_option_function<double>(
          "--store-gb",
          [&service](const double& gb) { service.store_limit_bytes = static_cast<std::uint64_t>(gb * 1e9); },
          "What the store may take on disk; a job that would take more is paused (no limit)")
      ->check(CLI::Range(0.001, 1e9));
  command
      ->add_option_function<double>(
          "--keep-days", [&service](const double& days) { service.keep_s = days * 86400; },
          "Delete jobs, results too, that have ended for longer; counted while a coordinator runs (for ever)")
      ->check(CLI::Range(0.0001, 1e6));
  command
      ->add_option("--task-time-s", service.task_time_s,
                   "Limit on a task's run time, where the job file says nothing (0: none)")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  command
      ->add_option("--task-memory-mb", service.task_memory_mb,
                   "Limit on the memory that a task may take, where the job file says nothing (0: none)")
      ->check(CLI::Range(std::uint64_t{0}, coordinator::kMostTaskMemory_mb))
      ->capture_default_str();
}

}  // namespace cairn::cli
