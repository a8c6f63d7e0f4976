// Lets workers finish what they run, and end.
#include <cstdio>

#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/service_text.h"

namespace cairn::cli {
namespace {

struct DrainArguments {
  ClientArguments client;
  std::vector<std::uint64_t> workers;
  bool all = false;
  bool json = false;
};

int Drain(const DrainArguments& options, const Invocation&) {
  if (options.workers.empty() != options.all) throw InputError("name workers by their numbers, or --all");
  coordinator::Client client = ConnectClient(options.client);
  std::vector<wire::WorkerInfo> told;
  for (const std::uint64_t number : options.all ? std::vector<std::uint64_t>{0} : options.workers)
    for (wire::WorkerInfo& worker : Take(client.Drain(number))) told.push_back(std::move(worker));
  if (options.json) {
    std::fputs(WorkersJson(told).c_str(), stdout);
    return kExitDone;
  }
  for (const wire::WorkerInfo& worker : told)
    std::printf("worker %llu (process %lld on %s) %s\n", static_cast<unsigned long long>(worker.number()),
                static_cast<long long>(worker.pid()), worker.host().c_str(),
                worker.assigned() == 0 ? "leaves" : ("leaves after " + worker.task()).c_str());
  if (told.empty()) std::puts("no worker is connected");
  return kExitDone;
}

}  // namespace

void AddDrain(Command app, Invocation& call) {
  Command command;
  auto options = AddCommand<DrainArguments>(app, call, "drain", "Lets workers finish what they run, and end",
                                            "cairn drain 3", Drain, &command);
  AddClientArguments(command, options->client);
  command.Add("WORKER", options->workers, "Their numbers, as status shows them").Positive();
  command.AddFlag("--all", options->all, "All that are connected");
  command.AddFlag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
