#include "coordinator/cli/commands/scale_keep.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <memory>
#include <thread>

#include "coordinator/cli/commands/scale_keys.h"
#include "coordinator/cli/common/allow_list_file.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/folder_lock.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/scale/scaler.h"
#include "schema/hash.h"
#include "schema/store/atomic_file.h"
#include "schema/wire/keys.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

// What is a machine's own loopback is another service on each.
std::string ServiceTag(const std::string& endpoint) {
  Hasher hasher;
  hasher.Add(std::string_view(endpoint));
  if (endpoint.starts_with("tcp://127.") || endpoint.starts_with("tcp://localhost") ||
      endpoint.starts_with("tcp://[::1]")) {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    hasher.Add(std::string_view(host.data()));
    hasher.Add(std::string_view(HomeFolder()));
  }
  return hasher.Finish().Hex().substr(0, 4);
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) fs::permissions(folder, fs::perms::owner_all, error);
  if (error) Throw(SystemFailure(folder, "cannot make the folder", error.value()));
}

std::string WhatIsWrongWithTag(const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 40 && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_';
  });
  return plain ? "" : "has other characters than letters, digits and '_', or more than 40";
}

std::unique_ptr<coordinator::WorkerKeys> MakeKeys(const ScaleArguments& options, const Scale& scale) {
  if (!scale.keyed) return std::make_unique<NoKeys>();
  const fs::path keys = options.keys.empty() ? fs::path(ConfigFolder()) : fs::path(options.keys);
  if (!fs::exists(keys / kAllowListName))
    throw InputError(
        (keys / kAllowListName).string() +
        " is not there: run this where the coordinator has its list of keys (--keys), each worker gets a "
        "key of its own");
  return std::make_unique<ListedKeys>(keys / kAllowListName, scale.folder / "keys", scale.prefix);
}

class ClientService : public coordinator::ScaledService {
 public:
  explicit ClientService(const ClientArguments& client) : client_(ConnectClient(client)) {}
  Result<coordinator::ScaleFacts> Ask() override {
    Result<coordinator::FleetFacts> fleet = client_.Fleet();
    if (!fleet.ok()) return fleet.status();
    return coordinator::ScaleFacts{std::move(fleet.value().workers), std::move(fleet.value().demand)};
  }
  cairn::Status Drain(std::uint64_t worker) override {
    const auto told = client_.Drain(worker);
    return told.ok() ? cairn::Status::Ok() : told.status();
  }

 private:
  coordinator::Client client_;
};

}  // namespace

Scale PrepareScale(const ScaleArguments& options, const std::string& engine) {
  if (options.policy.least > options.policy.most)
    throw InputError("--min " + std::to_string(options.policy.least) + " is more than --max " +
                     std::to_string(options.policy.most));
  Scale scale;
  scale.endpoint = options.client.connect.empty() ? DefaultEndpoint() : options.client.connect;
  scale.address = options.address.empty() ? scale.endpoint : options.address;
  scale.keyed = scale.address.starts_with("tcp://");
  if (engine != "local" && !scale.keyed)
    throw InputError("workers on other machines reach the coordinator by tcp://HOST:PORT, not " +
                     scale.address);
  const std::string tag = engine + "-" + (options.name.empty() ? ServiceTag(scale.endpoint) : options.name);
  scale.prefix = tag + "-";
  scale.folder =
      options.folder.empty() ? fs::path(HomeFolder()) / "scale" / tag : fs::absolute(options.folder) / tag;
  MakeFolder(scale.folder / "keys");
  if (scale.keyed)
    scale.server_key = Take(wire::ReadPublicKey(
        options.client.server_key.empty() ? DefaultKey("coordinator.pub") : options.client.server_key));
  scale.worker_options = {"--connect", scale.address, "--drain-s", std::to_string(options.drain_s)};
  if (options.task_memory_mb > 0) {
    scale.worker_options.emplace_back("--task-memory-mb");
    scale.worker_options.push_back(std::to_string(options.task_memory_mb));
  }
  return scale;
}

int KeepScale(const ScaleArguments& options, const Scale& scale, coordinator::Engine& engine,
              Console& console, coordinator::Tunnels* tunnels) {
  const FolderLock lock(scale.folder, "another `cairn scale` looks after these workers (" +
                                          scale.folder.string() +
                                          "): stop it, or give this one another --name");
  std::signal(SIGPIPE, SIG_IGN);
  const std::unique_ptr<coordinator::WorkerKeys> keys = MakeKeys(options, scale);
  ClientService service(options.client);
  // What is wrong from the beginning ends it; what goes wrong later is waited for.
  Take(service.Ask());
  Take(engine.List());
  coordinator::Scaler scaler({.policy = options.policy,
                              .prefix = scale.prefix,
                              .until_done = options.until_done,
                              .leave = options.down},
                             engine, service, *keys, console.Sink());
  const std::atomic<bool>& stop = StopOnSignals();
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  while (!stop) {
    if (tunnels != nullptr) tunnels->Keep();
    scaler.Turn(std::chrono::duration<double>(Clock::now() - begin).count());
    if (scaler.over()) return kExitDone;
    const auto next = Clock::now() + std::chrono::duration<double>(options.every_s);
    while (!stop && Clock::now() < next) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  if (scaler.workers() > 0)
    console.Log(Console::Level::kInfo,
                "ends; its workers go on: the same command finds them again, and with --down lets them go");
  return kExitDone;
}

void AddScaleOptions(Command command, ScaleArguments& options, bool needs_most) {
  command.Add("--min", options.policy.least, "Workers that stay, whatever there is to do")
      .Within(0, 1'000'000)
      .ShowDefault();
  const Argument most = command.Add(
      "--max", options.policy.most,
      needs_most ? "Most workers at a time" : "Most workers at a time (as many as there are cores)");
  most.Within(1, 1'000'000);
  if (needs_most) most.Required();
  command.Add("--work-s", options.policy.work_s, "So many seconds of work are worth one worker more")
      .Within(0.001, 1e9)
      .ShowDefault();
  command.Add("--idle-s", options.policy.idle_s, "A worker that had nothing to do for so long is drained")
      .Within(0.0, 1e9)
      .ShowDefault();
  command.Add("--cool-down-s", options.policy.cool_down_s, "None is drained so soon after one was started")
      .Within(0.0, 1e9)
      .ShowDefault();
  command.Add("--every-s", options.every_s, "It looks so often").Within(0.05, 3600.0).ShowDefault();
  command.Add("--drain-s", options.drain_s, "What a worker that is ended gets to finish its task")
      .Within(0, 100'000)
      .ShowDefault();
  command
      .Add("--task-memory-mb", options.task_memory_mb,
           "Limit on the memory of a task, for each worker (0: none)")
      .Within(std::uint64_t{0}, std::uint64_t{1'000'000'000});
  command.AddFlag("--until-done", options.until_done, "End once no job runs and all workers are gone");
  command.AddFlag("--down", options.down, "Start none, drain all, and end once they are gone");
  command.Add("--name", options.name, "Part of its workers' names, where there are two for one service")
      .Check(WhatIsWrongWithTag);
  command.Add("--worker", options.worker, "The program cairn-worker, as it is called there");
  AddClientArguments(command, options.client);
  command.Add("--address", options.address,
              "The coordinator, as workers reach it, where that is not --connect");
  command.Add("--keys", options.keys, "Folder of the coordinator's list of keys (tcp: ~/.config/cairn)")
      .ExistingFolder();
}

}  // namespace cairn::cli
