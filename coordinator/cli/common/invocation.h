// What a command line asks for, and how a command ends.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

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
std::shared_ptr<Options> AddCommand(CLI::App& app, Invocation& call, const char* name, const char* summary,
                                    const char* example, int (*run)(const Options&, const Invocation&),
                                    CLI::App** command) {
  auto options = std::make_shared<Options>();
  *command = app.add_subcommand(name, summary);
  (*command)->footer(std::string("Example:\n  ") + example);
  (*command)->callback(
      [options, &call, run] { call.run = [options, &call, run] { return run(*options, call); }; });
  return options;
}

// Each adds its command to `app`.
void AddRun(CLI::App& app, Invocation& call);
void AddCoordinator(CLI::App& app, Invocation& call);
void AddWorker(CLI::App& app, Invocation& call);
void AddSubmit(CLI::App& app, Invocation& call);
void AddJobs(CLI::App& app, Invocation& call);         // list, status, watch, results
void AddJobCommands(CLI::App& app, Invocation& call);  // pause, resume, cancel, retry, delete, priority
void AddWatch(CLI::App& app, Invocation& call);
void AddLogs(CLI::App& app, Invocation& call);
void AddDrain(CLI::App& app, Invocation& call);
void AddClean(CLI::App& app, Invocation& call);
void AddImport(CLI::App& app, Invocation& call);
void AddSimulate(CLI::App& app, Invocation& call);
void AddInspect(CLI::App& app, Invocation& call);
void AddEvaluate(CLI::App& app, Invocation& call);
void AddExport(CLI::App& app, Invocation& call);
void AddReport(CLI::App& app, Invocation& call);
void AddReproduce(CLI::App& app, Invocation& call);
void AddDiff(CLI::App& app, Invocation& call);
void AddKeys(CLI::App& app, Invocation& call);

}  // namespace cairn::cli
