// What the commands of `cairn scale` have in common, whatever the engine: their options, names, keys, and the
// loop that looks after the workers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/scale/engine.h"
#include "coordinator/scale/engines/tunnels.h"
#include "coordinator/scale/policy.h"

namespace cairn::cli {

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
  // Kubernetes
  std::string image, pod_template, context, name_space;
};

// What all engines share, made of what was asked for.
struct Scale {
  std::string endpoint;  // of the coordinator, as this command reaches it
  std::string address;   // as workers do
  bool keyed = false;
  std::string prefix;
  std::filesystem::path folder;  // of this command's, for this service
  std::string server_key;
  std::vector<std::string> worker_options;
};

// Throws InputError where what was asked for cannot be.
Scale PrepareScale(const ScaleArguments& options, const std::string& engine);
// Until it is stopped, or no worker is left where that was asked for; an exit code. `tunnels`: or null.
int KeepScale(const ScaleArguments& options, const Scale& scale, coordinator::Engine& engine,
              Console& console, coordinator::Tunnels* tunnels);
// `needs_most`: --max has no default.
void AddScaleOptions(Command command, ScaleArguments& options, bool needs_most);

}  // namespace cairn::cli
