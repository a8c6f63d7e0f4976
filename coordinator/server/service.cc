#include "coordinator/server/service.h"

#include <malloc.h>
#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "coordinator/server/address_lock.h"
#include "coordinator/server/metrics_port.h"
#include "coordinator/server/server.h"
#include "coordinator/server/zmq_transport.h"
#include "coordinator/store/recovery.h"
#include "schema/build_info.h"
#include "schema/numerics.h"
#include "schema/service_manager.h"

namespace cairn::coordinator {
namespace {

constexpr double kStep_s = 0.1;
constexpr std::chrono::seconds kMetricsEvery{1};

std::filesystem::path AllowListIn(const std::string& keys_dir) {
  return std::filesystem::path(keys_dir) / "allowed";
}

// A round's many small pieces, each freed by itself: the C library keeps such for a while and then, whenever
// something large comes or goes, looks at all of them. A quarter of the event loop's time went there.
void FreeAtOnce() { ::mallopt(M_MXFAST, 0); }

// As many connections as the system allows this user.
void RaiseFileLimit() {
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &files);
}

constexpr double kPatience_s = 1.5;  // to save what is unsaved when it ends

Result<std::optional<wire::ServerSecurity>> ReadSecurity(const std::string& keys_dir) {
  if (keys_dir.empty()) return std::optional<wire::ServerSecurity>();
  const std::filesystem::path dir = keys_dir;
  Result<wire::KeyPair> keys = wire::ReadKeyPair(dir / "coordinator.key");
  if (!keys.ok()) return keys.status();
  return std::optional(wire::ServerSecurity{std::move(keys).value(), AllowListIn(keys_dir)});
}

std::vector<std::filesystem::path> ResultFilesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& path : EntriesOf(folder))
    if (path.extension() == ".h5") files.push_back(path);
  return files;
}

void Turn(Server& server, const StoreFolder& folder, MetricsPort* metrics, bool drain,
          const std::atomic<bool>& stop) {
  ServiceManager manager;
  manager.Ready();
  auto publish_at = std::chrono::steady_clock::now();
  while (!stop && folder.TakenOver().empty() && !(drain && server.HasDrained())) {
    server.Step(kStep_s);
    manager.Alive();
    if (metrics == nullptr || std::chrono::steady_clock::now() < publish_at) continue;
    metrics->Publish(server.TakeMetrics());
    publish_at = std::chrono::steady_clock::now() + kMetricsEvery;
  }
  manager.Stopping();
}

}  // namespace

Status Serve(const ServiceOptions& options, const LogSink& log, const std::atomic<bool>& stop) {
  const Result<std::optional<wire::ServerSecurity>> security = ReadSecurity(options.keys_dir);
  if (!security.ok()) return security.status();
  Result<StoreFolder> folder = StoreFolder::OpenToServe(options.store_dir);
  if (!folder.ok()) return folder.status();
  RaiseFileLimit();
  FreeAtOnce();
  const Result<AddressLock> address =
      AddressLock::Take(options.listen, "store " + folder.value().dir().string());
  if (!address.ok()) return address.status();
  const Result<std::unique_ptr<Transport>> transport =
      ListenZmq(options.listen, security.value(), options.sockets);
  if (!transport.ok()) return transport.status();
  std::unique_ptr<MetricsPort> metrics;
  if (!options.metrics.empty()) {
    Result<std::unique_ptr<MetricsPort>> port = MetricsPort::Listen(options.metrics);
    if (!port.ok()) return port.status();
    metrics = std::move(port).value();
    log(Severity::kInfo, "metrics at http://" + metrics->address() + "/metrics");
  }
  // Last: who is taken over ends, and nobody would serve where this one cannot.
  if (Status served = folder.value().Serve(options.take_over); !served.ok()) return served;
  Result<JobTable> table = OpenJobTable(folder.value(), log);
  if (!table.ok()) {
    folder.value().GiveBack();
    return table.status();
  }

  ServerOptions server_options;
  FixNumericsOfThread();
  server_options.core.build = ThisBuild();
  server_options.core.checkpoint_interval_s = options.checkpoint_interval_s;
  server_options.core.checkpoint_rounds = options.checkpoint_rounds;
  server_options.core.keep_s = options.keep_s;
  server_options.store_limit_bytes = options.store_limit_bytes;
  server_options.core.task_time_s = options.task_time_s;
  server_options.core.task_memory_mb = options.task_memory_mb;
  server_options.drains = options.drain;
  server_options.job_ended = options.job_ended;
  server_options.key_limits = options.key_limits;
  server_options.memory_bytes = options.memory_bytes;
  server_options.sent_bytes = options.sent_bytes;
  server_options.largest_input_bytes = options.sockets.limits.message_bytes;
  if (!options.keys_dir.empty()) server_options.allow_list = AllowListIn(options.keys_dir);
  server_options.result_path = [dir = folder.value().dir()](const std::string& job,
                                                            const std::string& stage) {
    return dir / "results" / job / (stage + ".h5");
  };
  server_options.result_files = [dir = folder.value().dir()](const std::string& job) {
    return ResultFilesIn(dir / "results" / job);
  };
  server_options.results_folder = [dir = folder.value().dir()](const std::string& job) {
    return dir / "results" / job;
  };
  folder.value().FinishForgetting(server_options.results_folder);
  std::optional<Server> server;
  try {
    server.emplace(folder.value(), *transport.value(), std::move(table).value(), std::move(server_options),
                   log);
  } catch (const UnreadableStore& error) {
    folder.value().GiveBack();
    return {Code::kIo, error.what()};
  }
  log(Severity::kInfo, "listening on " + options.listen + ", store " + options.store_dir);
  Turn(*server, folder.value(), metrics.get(), options.drain, stop);
  if (const std::string lost = folder.value().TakenOver(); !lost.empty())
    return {Code::kBusy, options.store_dir + ": " + lost};
  if (!stop) log(Severity::kInfo, "no job runs any more: the service ends (--drain)");
  if (!server->Shut(kPatience_s)) log(Severity::kWarning, "ended before the last rounds were saved");
  server.reset();  // what it had to write is written
  if (const std::string lost = folder.value().TakenOver(); !lost.empty())
    return {Code::kBusy, options.store_dir + ": " + lost};
  folder.value().GiveBack();
  return Status::Ok();
}

}  // namespace cairn::coordinator
