// Removes from a store what nobody needs: through the coordinator that has it, or, where none runs, itself.
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/job_text.h"
#include "coordinator/store/cleaner.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

struct CleanArguments {
  ClientArguments client;
  std::string store;
  coordinator::CleanOptions clean;
  bool json = false;
};

coordinator::Cleaned CleanHere(const CleanArguments& options) {
  const std::filesystem::path dir = options.store;
  if (!std::filesystem::is_directory(dir / "checkpoints")) throw InputError(options.store + " is no store");
  const coordinator::StoreFolder folder = Take(coordinator::StoreFolder::OpenAsItIs(dir));
  return coordinator::CleanStore(folder, options.clean, coordinator::HashesInPack);
}

coordinator::Cleaned CleanThere(const CleanArguments& options) {
  coordinator::Client client = ConnectClient(options.client);
  const wire::Reply reply = Take(client.Clean(options.clean.damaged, options.clean.dry_run));
  return {{reply.cleaned().begin(), reply.cleaned().end()}, reply.message()};
}

std::string CleanedJson(const coordinator::Cleaned& cleaned, bool dry_run) {
  nlohmann::ordered_json json = {
      {"dry_run", dry_run}, {"removed", nlohmann::ordered_json::array()}, {"note", cleaned.note}};
  for (const wire::Cleaned& kind : cleaned.removed)
    json["removed"].push_back({{"what", kind.what()}, {"files", kind.files()}, {"bytes", kind.bytes()}});
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

int Clean(const CleanArguments& options, const Invocation&) {
  const coordinator::Cleaned cleaned = options.store.empty() ? CleanThere(options) : CleanHere(options);
  if (options.json) {
    std::fputs(CleanedJson(cleaned, options.clean.dry_run).c_str(), stdout);
    return kExitDone;
  }
  for (const wire::Cleaned& kind : cleaned.removed)
    std::printf("%s %llu %s, %s\n", options.clean.dry_run ? "would remove" : "removed",
                static_cast<unsigned long long>(kind.files()), kind.what().c_str(),
                BytesText(kind.bytes()).c_str());
  if (cleaned.removed.empty()) std::printf("nothing to remove\n");
  if (!cleaned.note.empty()) std::printf("%s\n", cleaned.note.c_str());
  return kExitDone;
}

}  // namespace

void AddClean(Command app, Invocation& call) {
  Command command;
  const auto options =
      AddCommand<CleanArguments>(app, call, "clean", "Removes from a coordinator's store what nobody needs",
                                 "cairn clean --dry-run\n  cairn clean --damaged", Clean, &command);
  AddClientArguments(command, options->client);
  command.Add("--store", options->store, "A store that no coordinator has at the moment, by its folder");
  command.AddFlag("--damaged", options->clean.damaged,
                  "Also what was quarantined as damaged, and jobs that are lost");
  command.AddFlag("--dry-run", options->clean.dry_run, "Only say what would be removed");
  command.AddFlag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
