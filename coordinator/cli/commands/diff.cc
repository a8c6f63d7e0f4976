#include "datasets/inspect/diff.h"

#include <cstdio>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/result_file.h"

namespace cairn::cli {
namespace {

struct DiffArguments {
  std::string a;
  std::string b;
  bool json = false;
};

// As diff(1): 0 the same, 1 they differ, 2 trouble.
int Diff(const DiffArguments& options, const Invocation&) {
  const datasets::Difference difference = Take(datasets::DiffPaths(options.a, options.b));
  for (const std::string& file : difference.changed) WarnOfChanged(file);
  std::fputs((options.json ? datasets::DiffJson(difference) : datasets::DiffText(difference)).c_str(),
             stdout);
  return difference.same() ? kExitDone : kExitFailed;
}

}  // namespace

void AddDiff(Command app, Invocation& call) {
  Command command;
  const auto options = AddCommand<DiffArguments>(app, call, "diff",
                                                 "Are two Cairn files, or those of two folders, the same, "
                                                 "bit for bit, and where not (seconds and hosts aside)",
                                                 "cairn diff one-worker five-workers", Diff, &command);
  command.Add("A", options->a, "A Cairn file (.h5), or a folder of them").Required();
  command.Add("B", options->b, "Another").Required();
  command.AddFlag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
