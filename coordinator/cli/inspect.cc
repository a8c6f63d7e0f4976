#include "datasets/inspect.h"

#include <cstdio>
#include <filesystem>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/invocation.h"
#include "coordinator/cli/result_file.h"
#include "coordinator/cli/suggest.h"

namespace cairn::cli {
namespace {

struct Options {
  std::string file;
  bool json = false;
};

int Inspect(const Options& options, const Invocation&) {
  if (std::filesystem::is_directory(options.file)) {
    throw InputError("'" + options.file + "' is a folder; which file? " + Join(FilesOf(options.file)));
  }
  const datasets::Inspection inspection = Take(datasets::Inspect(options.file));
  if (inspection.changed) WarnOfChanged(options.file);
  std::fputs((options.json ? datasets::InspectJson(inspection) : datasets::InspectText(inspection)).c_str(),
             stdout);
  return kExitDone;
}

}  // namespace

void AddInspect(CLI::App& app, Invocation& call) {
  CLI::App* command = nullptr;
  const auto options =
      AddCommand<Options>(app, call, "inspect", "What is in a Cairn file, every checksum looked at",
                          "cairn inspect log.h5", Inspect, &command);
  command->add_option("FILE", options->file, "A log, a result, a checkpoint")->required();
  command->add_flag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
