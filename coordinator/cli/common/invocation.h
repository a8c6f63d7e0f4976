// What a command line asks for, and how a command ends.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "schema/command_line/command.h"

namespace cairn::cli {

inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;     // through no fault of the input
inline constexpr int kExitBadInput = 2;   // bad usage or input
inline constexpr int kExitStopped = 130;  // by Ctrl-C or SIGTERM; the same run again resumes

// Filled in while the command line is parsed; run afterwards, so that a command's errors are not a parser's.
struct Invocation {
  std::function<int()> run;
  bool log_json = false;  // logs as JSON lines
  bool verbose = false;   // informative lines too
};

// A command's options live as long as its subcommand.
template <class Options>
std::shared_ptr<Options> AddCommand(Command app, Invocation& call, const char* name, const char* summary,
                                    const char* example, int (*run)(const Options&, const Invocation&),
                                    Command* command) {
  auto options = std::make_shared<Options>();
  *command = app.AddCommand(name, summary);
  command->Footer(std::string("Example:\n  ") + example);
  command->WhenGiven(
      [options, &call, run] { call.run = [options, &call, run] { return run(*options, call); }; });
  return options;
}

// Each adds its command to `app`.
void AddRun(Command app, Invocation& call);
void AddMap(Command app, Invocation& call);
void AddCoordinator(Command app, Invocation& call);
void AddWorker(Command app, Invocation& call);
void AddPage(Command app, Invocation& call);
void AddSubmit(Command app, Invocation& call);
void AddJobs(Command app, Invocation& call);         // list, status, watch, results
void AddJobCommands(Command app, Invocation& call);  // pause, resume, cancel, retry, delete, priority
void AddWatch(Command app, Invocation& call);
void AddLogs(Command app, Invocation& call);
void AddScale(Command app, Invocation& call);  // local, ssh, slurm
void AddDrain(Command app, Invocation& call);
void AddBackup(Command app, Invocation& call);  // restore too
void AddCheck(Command app, Invocation& call);
void AddClean(Command app, Invocation& call);
void AddImport(Command app, Invocation& call);
void AddLandmarks(Command app, Invocation& call);
void AddSimulate(Command app, Invocation& call);
void AddInspect(Command app, Invocation& call);
void AddEvaluate(Command app, Invocation& call);
void AddExport(Command app, Invocation& call);
void AddReport(Command app, Invocation& call);
void AddDiff(Command app, Invocation& call);
void AddKeys(Command app, Invocation& call);

}  // namespace cairn::cli
