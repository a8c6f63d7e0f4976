// Looks through a store that no coordinator has at the moment.
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/job_text.h"
#include "coordinator/store/recovery.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

struct CheckArguments {
  std::string store;
  bool adopt = false;
  bool json = false;
};

void Say(const std::string& what, const std::string& why) {
  std::printf("%s%s\n", Escaped(what).c_str(), why.c_str());
}

// Damage, and what was found and left: somebody should look.
int CheckStoreOf(const CheckArguments& options, const Invocation&) {
  const std::string dir = options.store.empty() ? HomeFolder() + "/store" : options.store;
  if (!std::filesystem::is_directory(std::filesystem::path(dir) / "checkpoints"))
    throw InputError(dir + " is no store");
  const coordinator::StoreFolder folder = Take(coordinator::StoreFolder::OpenAsItIs(dir));
  const coordinator::StoreFindings found =
      coordinator::CheckStore(folder, folder.dir() / "results", options.adopt);
  const bool fine = found.damaged.empty() && (found.orphaned.empty() || options.adopt);
  if (options.json) {
    std::fputs(Dump({{"jobs", found.jobs},
                     {"damaged", found.damaged},
                     {"orphaned", found.orphaned},
                     {"adopted", options.adopt},
                     {"unclaimed", found.unclaimed}})
                   .c_str(),
               stdout);
    return fine ? kExitDone : kExitFailed;
  }
  std::printf("%zu %s whole\n", found.jobs, found.jobs == 1 ? "job" : "jobs");
  for (const std::string& damaged : found.damaged) Say("damaged: " + damaged, "");
  for (const std::string& job : found.orphaned)
    Say("job " + job, options.adopt ? " is taken back: it is done"
                                    : " is lost, but for all its results: --adopt makes it one that is done");
  for (const std::string& folder_name : found.unclaimed)
    Say("results/" + folder_name, " is no job's, and not all that a job has published");
  return fine ? kExitDone : kExitFailed;
}

}  // namespace

void AddCheck(Command app, Invocation& call) {
  Command command;
  const auto options = AddCommand<CheckArguments>(
      app, call, "check", "Looks through a store that no coordinator has: what is damaged, what is lost",
      "cairn check && cairn coordinator\n  cairn check --adopt", CheckStoreOf, &command);
  command.Add("--store", options->store, "The coordinator's store (~/.cairn/store)");
  command.AddFlag("--adopt", options->adopt,
                  "Make jobs again of results that are whole and of which nothing else is left");
  command.AddFlag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
