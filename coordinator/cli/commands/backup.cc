// Copies of a store that may be served meanwhile, and their way back.
#include "coordinator/store/backup.h"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/invocation.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct BackupArguments {
  std::string folder;
  std::string store;
  bool check = false;
  bool unfinished = false;
  bool json = false;
};

std::string Jobs(std::size_t count) { return std::to_string(count) + (count == 1 ? " job" : " jobs"); }

// Where something was damaged it says so, and ends with 1.
int Tell(const coordinator::BackupFacts& facts, const std::string& where, bool as_json) {
  if (as_json) {
    const nlohmann::ordered_json json = {
        {"jobs", facts.jobs}, {"files", facts.files}, {"bytes", facts.bytes}, {"damaged", facts.damaged}};
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    std::printf("%s in %s; copied %zu %s, %s\n", Jobs(facts.jobs).c_str(), where.c_str(), facts.files,
                facts.files == 1 ? "file" : "files", BytesText(facts.bytes).c_str());
  }
  for (const std::string& damaged : facts.damaged)
    std::fprintf(stderr, "cairn: not copied: %s\n", Escaped(damaged).c_str());
  return facts.damaged.empty() ? kExitDone : kExitFailed;
}

int Backup(const BackupArguments& options, const Invocation&) {
  const std::string store = options.store.empty() ? HomeFolder() + "/store" : options.store;
  return Tell(Take(coordinator::BackUp(store, options.folder, options.check)), options.folder, options.json);
}

int Restore(const BackupArguments& options, const Invocation&) {
  const std::string store = options.store.empty() ? HomeFolder() + "/store" : options.store;
  std::error_code error;
  if (!options.unfinished && fs::exists(options.folder, error) &&
      !fs::exists(fs::path(options.folder) / coordinator::kBackupMark, error))
    throw InputError(options.folder +
                     " is no backup that was made to its end; --unfinished takes what there is of one");
  return Tell(Take(coordinator::RestoreStore(options.folder, store)), store, options.json);
}

}  // namespace

void AddBackup(Command app, Invocation& call) {
  Command command;
  auto options =
      AddCommand<BackupArguments>(app, call, "backup", "Copies a store, also one that is being served",
                                  "cairn backup /mnt/safe/cairn", Backup, &command);
  command.Add("DIR", options->folder, "Where the copy goes; over an earlier one only what is new is copied")
      .Required();
  command.Add("--store", options->store, "The coordinator's store (~/.cairn/store)");
  command.AddFlag("--check", options->check,
                  "Read all that was copied before, too, and copy anew what is damaged");
  command.AddFlag("--json", options->json, "As JSON");

  options =
      AddCommand<BackupArguments>(app, call, "restore", "Makes a store of a backup",
                                  "cairn restore /mnt/safe/cairn && cairn coordinator", Restore, &command);
  command.Add("DIR", options->folder, "What `cairn backup` made").Required();
  command.Add("--store", options->store, "Where the store goes; nothing may be there (~/.cairn/store)");
  command.AddFlag("--unfinished", options->unfinished, "Also of a backup that was cut off or found damage");
  command.AddFlag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
