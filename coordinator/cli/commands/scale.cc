// cairn scale: keeps as many workers as the service's jobs could use, on an engine that people have.
#include <thread>

#include "coordinator/cli/commands/scale_keep.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/scale/engines/hosts_engine.h"
#include "coordinator/scale/engines/kubernetes_engine.h"
#include "coordinator/scale/engines/slurm_engine.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFileBytes = 1 << 20;  // of what a person writes

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
  const Scale scale = PrepareScale(options, "local");
  Console console(Talkative(call));
  coordinator::HostsOptions hosts = HostsOf(options, scale, console);
  hosts.hosts = {{"this machine", options.policy.most, 0}};
  hosts.shell = [](const coordinator::Host&) { return std::vector<std::string>{"sh", "-s"}; };
  hosts.folder = (scale.folder / "workers").string();
  coordinator::HostsEngine engine(std::move(hosts));
  return KeepScale(options, scale, engine, console, nullptr);
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
  ScaleArguments options = given;
  const std::vector<coordinator::Host> list =
      coordinator::ParseHosts(Take(ReadSmallFile(options.hosts, kMostFileBytes)), options.hosts);
  int cores = 0;
  for (const coordinator::Host& host : list) cores += host.cores;
  if (options.policy.most == 0) options.policy.most = cores;
  if (options.worker.empty()) options.worker = "cairn-worker";
  if (options.tunnel_port > 0) options.address = "tcp://127.0.0.1:" + std::to_string(options.tunnel_port);
  const Scale scale = PrepareScale(options, "ssh");
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
  return KeepScale(options, scale, engine, console, tunnels.get());
}

int ScaleSlurm(const ScaleArguments& given, const Invocation& call) {
  ScaleArguments options = given;
  options.worker = options.worker.empty() ? WorkerProgram() : fs::absolute(options.worker).string();
  if (!options.partition.empty())
    options.sbatch.insert(options.sbatch.begin(), "--partition=" + options.partition);
  const Scale scale = PrepareScale(options, "slurm");
  Check(WriteTextAtomically(scale.folder / "keys" / "coordinator.pub", scale.server_key + "\n"));
  Console console(Talkative(call));
  coordinator::SlurmEngine engine({.prefix = scale.prefix,
                                   .folder = scale.folder.string(),
                                   .worker = options.worker,
                                   .options = scale.worker_options,
                                   .keyed = scale.keyed,
                                   .sbatch = options.sbatch,
                                   .drain_s = options.drain_s});
  return KeepScale(options, scale, engine, console, nullptr);
}

// Pods are called as their workers, and Kubernetes takes no other names.
void CheckPodNames(const ScaleArguments& options) {
  constexpr std::size_t kMost = 30;
  const bool plain = options.name.size() <= kMost && std::ranges::all_of(options.name, [](char c) {
                       return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
                     });
  if (!plain)
    throw InputError("--name " + options.name +
                     ": names of pods have small letters and digits alone, here at most " +
                     std::to_string(kMost));
}

int ScaleKubernetes(const ScaleArguments& options, const Invocation& call) {
  CheckPodNames(options);
  const Scale scale = PrepareScale(options, "kubernetes");
  Check(WriteTextAtomically(scale.folder / "keys" / "coordinator.pub", scale.server_key + "\n"));
  Console console(Talkative(call));
  coordinator::KubernetesOptions kubernetes;
  if (!options.context.empty()) kubernetes.kubectl.push_back("--context=" + options.context);
  if (!options.name_space.empty()) kubernetes.kubectl.push_back("--namespace=" + options.name_space);
  kubernetes.template_file = options.pod_template.empty() ? "the template" : options.pod_template;
  kubernetes.pod_template = options.pod_template.empty()
                                ? coordinator::DefaultPodTemplate()
                                : Take(ReadSmallFile(options.pod_template, kMostFileBytes));
  kubernetes.pod = {.label = scale.folder.filename().string(),
                    .image = options.image,
                    .worker = options.worker,
                    .options = scale.worker_options,
                    .keyed = scale.keyed,
                    .drain_s = options.drain_s};
  kubernetes.keys = (scale.folder / "keys").string();
  coordinator::KubernetesEngine engine(std::move(kubernetes));
  return KeepScale(options, scale, engine, console, nullptr);
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
  AddScaleOptions(command, *options, false);

  options = AddCommand<ScaleArguments>(scale, call, "ssh", "Workers on hosts that ssh reaches without asking",
                                       "cairn scale ssh --hosts hosts.txt --connect tcp://hub:7017", ScaleSsh,
                                       &command);
  command.Add("--hosts", options->hosts, "File: HOST CORES [MEMORY_MB] a line").Required();
  command
      .Add("--tunnel", options->tunnel_port,
           "Workers reach the coordinator through ssh, at this port of their own machine")
      .Within(1, 65535);
  command.Add("--ssh-option", options->ssh_options, "NAME=VALUE, as ssh -o; again for another").OneEachTime();
  AddScaleOptions(command, *options, false);

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
  AddScaleOptions(command, *options, true);

  options =
      AddCommand<ScaleArguments>(scale, call, "kubernetes", "Workers as pods of a Kubernetes cluster",
                                 "cairn scale kubernetes --max 200 --image registry.example/cairn:0.1.0 "
                                 "--connect tcp://hub:7017",
                                 ScaleKubernetes, &command);
  command.Add("--image", options->image, "The workers' image (the template's)");
  command.Add("--template", options->pod_template,
              "File: a pod, of which all are made (deploy/kubernetes/worker-pod.yaml)");
  command.Add("--namespace", options->name_space, "Where in the cluster (kubectl's own)");
  command.Add("--context", options->context, "Which cluster (kubectl's own)");
  AddScaleOptions(command, *options, true);
}

}  // namespace cairn::cli
