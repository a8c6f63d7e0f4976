// cairn scale: keeps as many workers as the service's jobs could use, on an engine that people have.
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "coordinator/cli/commands/allow_list_file.h"
#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/commands/scale_keys.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/folder_lock.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/scale/engines/hosts_engine.h"
#include "coordinator/scale/engines/slurm_engine.h"
#include "coordinator/scale/engines/tunnels.h"
#include "coordinator/scale/scaler.h"
#include "schema/hash.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"
#include "schema/wire/keys.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct ScaleArguments {
  ClientArguments client;
  coordinator::PolicyOptions policy{.least = 0, .most = 0};
  std::string name;
  std::string keys;     // folder of the coordinator's list
  std::string address;  // where workers find the coordinator
  std::string worker;   // the program
  double every_s = 2;
  int drain_s = 60;
  std::uint64_t task_memory_mb = 0;
  bool until_done = false, down = false;
  // ssh
  std::string hosts;
  std::vector<std::string> ssh_options;
  int tunnel_port = 0;
  // Slurm
  std::string folder, partition;
  std::vector<std::string> sbatch;
};

// What all engines share, made of what was asked for.
struct Scale {
  std::string endpoint;  // of the coordinator, as this command reaches it
  std::string address;   // as workers do
  bool keyed = false;
  std::string prefix;
  fs::path folder;  // of this command's, for this service
  std::string server_key;
  std::vector<std::string> worker_options;
};

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

Scale Prepare(const ScaleArguments& options, const std::string& engine) {
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

int Keep(const ScaleArguments& options, const Scale& scale, coordinator::Engine& engine, Console& console,
         coordinator::Tunnels* tunnels) {
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

Invocation Talkative(const Invocation& call) {
  Invocation talkative = call;
  talkative.verbose = true;  // what it does is all that there is to see of it
  return talkative;
}

coordinator::HostsOptions HostsOf(const ScaleArguments& options, const Scale& scale, Console& console) {
  coordinator::HostsOptions hosts;
  hosts.options = scale.worker_options;
  hosts.worker = options.worker;
  hosts.log = console.Sink();
  if (scale.keyed) {
    hosts.keys = (scale.folder / "keys").string();
    hosts.server_key = scale.server_key;
  }
  return hosts;
}

int ScaleLocal(const ScaleArguments& given, const Invocation& call) {
  ScaleArguments options = given;
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (options.policy.most == 0) options.policy.most = cores;
  options.worker = options.worker.empty() ? WorkerProgram() : fs::absolute(options.worker).string();
  const Scale scale = Prepare(options, "local");
  Console console(Talkative(call));
  coordinator::HostsOptions hosts = HostsOf(options, scale, console);
  hosts.hosts = {{"this machine", options.policy.most, 0}};
  hosts.shell = [](const coordinator::Host&) { return std::vector<std::string>{"sh", "-s"}; };
  hosts.folder = (scale.folder / "workers").string();
  coordinator::HostsEngine engine(std::move(hosts));
  return Keep(options, scale, engine, console, nullptr);
}

// Nobody is there to be asked, and a host that is silent is away.
const std::vector<std::string> kSsh = {"ssh",
                                       "-o",
                                       "BatchMode=yes",
                                       "-o",
                                       "ConnectTimeout=5",
                                       "-o",
                                       "ServerAliveInterval=3",
                                       "-o",
                                       "ServerAliveCountMax=2"};

// One connection to each host serves for all, where its socket's name can be said: it is not too long for
// one, and nothing in it means something to ssh.
std::vector<std::string> SshWords(const ScaleArguments& options, const fs::path& folder) {
  std::vector<std::string> words = kSsh;
  constexpr std::size_t kMostFolder = 45;
  const std::string path = folder.string();
  if (path.size() <= kMostFolder && path.find_first_of("%\"'\\$") == std::string::npos)
    for (const std::string& option : {std::string("ControlMaster=auto"), std::string("ControlPersist=60"),
                                      "ControlPath=\"" + path + "/%C\""})
      words.insert(words.end(), {"-o", option});
  for (const std::string& option : options.ssh_options) words.insert(words.end(), {"-o", option});
  return words;
}

// ssh's own for a tunnel, of a connection of its own.
std::vector<std::string> TunnelWords(const ScaleArguments& options, const std::string& endpoint,
                                     const std::string& host) {
  std::vector<std::string> words = kSsh;
  for (const char* option : {"ControlPath=none", "ExitOnForwardFailure=yes"})
    words.insert(words.end(), {"-o", option});
  words.emplace_back("-N");
  for (const std::string& option : options.ssh_options) words.insert(words.end(), {"-o", option});
  words.insert(words.end(), {"-R", "127.0.0.1:" + std::to_string(options.tunnel_port) + ":" +
                                       endpoint.substr(std::string("tcp://").size())});
  words.push_back(host);
  return words;
}

int ScaleSsh(const ScaleArguments& given, const Invocation& call) {
  constexpr std::size_t kMostHostsBytes = 1 << 20;
  ScaleArguments options = given;
  const std::vector<coordinator::Host> list =
      coordinator::ParseHosts(Take(ReadSmallFile(options.hosts, kMostHostsBytes)), options.hosts);
  int cores = 0;
  for (const coordinator::Host& host : list) cores += host.cores;
  if (options.policy.most == 0) options.policy.most = cores;
  if (options.worker.empty()) options.worker = "cairn-worker";
  if (options.tunnel_port > 0) options.address = "tcp://127.0.0.1:" + std::to_string(options.tunnel_port);
  const Scale scale = Prepare(options, "ssh");
  Console console(Talkative(call));
  std::unique_ptr<coordinator::Tunnels> tunnels;
  if (options.tunnel_port > 0) {
    if (!scale.endpoint.starts_with("tcp://"))
      throw InputError("a tunnel leads to tcp://HOST:PORT, not " + scale.endpoint);
    std::vector<std::vector<std::string>> commands;
    for (const coordinator::Host& host : list)
      commands.push_back(TunnelWords(options, scale.endpoint, host.name));
    tunnels = std::make_unique<coordinator::Tunnels>(std::move(commands), console.Sink());
  }
  coordinator::HostsOptions hosts = HostsOf(options, scale, console);
  hosts.hosts = list;
  hosts.shell = [words = SshWords(options, scale.folder)](const coordinator::Host& host) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {host.name, "sh -s"});
    return all;
  };
  hosts.folder = ".cairn/scale/" + scale.folder.filename().string();
  coordinator::HostsEngine engine(std::move(hosts));
  return Keep(options, scale, engine, console, tunnels.get());
}

int ScaleSlurm(const ScaleArguments& given, const Invocation& call) {
  ScaleArguments options = given;
  options.worker = options.worker.empty() ? WorkerProgram() : fs::absolute(options.worker).string();
  if (!options.partition.empty())
    options.sbatch.insert(options.sbatch.begin(), "--partition=" + options.partition);
  const Scale scale = Prepare(options, "slurm");
  Check(WriteTextAtomically(scale.folder / "keys" / "coordinator.pub", scale.server_key + "\n"));
  Console console(Talkative(call));
  coordinator::SlurmEngine engine({.prefix = scale.prefix,
                                   .folder = scale.folder.string(),
                                   .worker = options.worker,
                                   .options = scale.worker_options,
                                   .keyed = scale.keyed,
                                   .sbatch = options.sbatch,
                                   .drain_s = options.drain_s});
  return Keep(options, scale, engine, console, nullptr);
}

void AddCommon(Command command, ScaleArguments& options, bool needs_most) {
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

}  // namespace

void AddScale(Command app, Invocation& call) {
  Command scale = app.AddCommand(
      "scale", "Starts and drains workers by what there is to do: here, on hosts, on a cluster");
  scale.Footer(
      "Example:\n  cairn scale local --max 8\n  cairn scale slurm --max 200 --connect tcp://hub:7017");
  scale.NeedsCommand();
  Command command;
  auto options = AddCommand<ScaleArguments>(scale, call, "local", "Workers on this machine",
                                            "cairn scale local --max 8 --min 1", ScaleLocal, &command);
  AddCommon(command, *options, false);

  options = AddCommand<ScaleArguments>(scale, call, "ssh", "Workers on hosts that ssh reaches without asking",
                                       "cairn scale ssh --hosts hosts.txt --connect tcp://hub:7017", ScaleSsh,
                                       &command);
  command.Add("--hosts", options->hosts, "File: HOST CORES [MEMORY_MB] a line").Required();
  command
      .Add("--tunnel", options->tunnel_port,
           "Workers reach the coordinator through ssh, at this port of their own machine")
      .Within(1, 65535);
  command.Add("--ssh-option", options->ssh_options, "NAME=VALUE, as ssh -o; again for another").OneEachTime();
  AddCommon(command, *options, false);

  options =
      AddCommand<ScaleArguments>(scale, call, "slurm", "Workers as elements of job arrays of a Slurm cluster",
                                 "cairn scale slurm --max 200 --partition long --sbatch=--time=4:00:00 "
                                 "--connect tcp://hub:7017",
                                 ScaleSlurm, &command);
  command.Add("--partition", options->partition, "Where they run (the cluster's default)");
  command.Add("--sbatch", options->sbatch, "An option of sbatch's: --sbatch=--mem=4G; again for another")
      .OneEachTime();
  command.Add("--folder", options->folder,
              "For keys and logs, on a file system that all nodes see (~/.cairn/scale)");
  AddCommon(command, *options, true);
}

}  // namespace cairn::cli
