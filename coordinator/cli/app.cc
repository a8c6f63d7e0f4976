#include "coordinator/cli/app.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/common/suggest.h"
#include "coordinator/cli/job_file/arguments.h"
#include "coordinator/cli/output/output.h"
#include "coordinator/cli/output/pipeline_text.h"
#include "schema/process_limits.h"
#include "schema/store/atomic_file.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

void Complain(std::string problem) {
  while (!problem.empty() && problem.back() == '\n') problem.pop_back();
  std::fprintf(stderr, "cairn: %s\n", problem.c_str());
}

void AddCommands(Command app, Invocation& call) {
  AddRun(app, call);
  AddCoordinator(app, call);
  AddSimulate(app, call);
  AddImport(app, call);
  AddPipelines(app, call);
  AddInspect(app, call);
  AddEvaluate(app, call);
  AddReport(app, call);
  AddReproduce(app, call);
  AddExport(app, call);
  AddDiff(app, call);
  AddWorker(app, call);
  AddSubmit(app, call);
  AddJobs(app, call);
  AddWatch(app, call);
  AddLogs(app, call);
  AddJobCommands(app, call);
  AddDrain(app, call);
  AddClean(app, call);
  AddKeys(app, call);
}

// Over TCP the keys are those in the folder of keys, where nobody says otherwise.
void AddKeyArguments(std::vector<std::string>& words) {
  const auto any = [&words](const char* what) {
    return std::ranges::any_of(words, [what](const std::string& word) { return word.starts_with(what); });
  };
  const bool tcp =
      std::ranges::any_of(words, [](const std::string& w) { return w.find("tcp://") != std::string::npos; });
  if (tcp && !any("--key")) words.push_back("--key=" + DefaultKey("worker.key"));
  if (tcp && !any("--server-key")) words.push_back("--server-key=" + DefaultKey("coordinator.pub"));
}

// `cairn worker …` becomes cairn-worker: the science stays out of this process. Without --connect it looks
// for the coordinator where `cairn coordinator` listens when nobody says otherwise.
int BecomeWorker(int argc, char** argv) {
  std::vector<std::string> words = {WorkerProgram()};
  for (int i = 2; i < argc; ++i) words.emplace_back(argv[i]);
  const bool elsewhere = std::ranges::any_of(words, [](const std::string& word) {
    return word.starts_with("--connect") || word == "--help" || word == "-h" || word == "--describe" ||
           word == "--version";
  });
  if (!elsewhere) words.push_back("--connect=" + DefaultEndpoint());
  AddKeyArguments(words);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(pointers[0], pointers.data());
  throw WorldError(words[0] + " cannot be run");
}

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

// Of `cairn export foo`, where export has formats; empty where that is not what is wrong.
std::string UnknownSubcommand(const CLI::App& app, const std::string& command, int argc, char** argv) {
  if (command.empty() || argc < 3) return "";
  const std::vector<std::string> known = CommandNames(*app.get_subcommand(command));
  const std::string word = argv[2];
  if (known.empty() || word.starts_with('-') || std::ranges::find(known, word) != known.end()) return "";
  return "cairn " + command + ": there is no '" + word + "'" + Suggest(word, known);
}

void AddFlags(const CLI::App& app, std::vector<std::string>* flags) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) flags->push_back("--" + name);
}

// Of `cairn run … --ouput result`: the first flag that the command does not know, with what was meant; empty
// where all are known.
std::string UnknownFlag(const CLI::App& app, const std::string& command, int argc, char** argv) {
  std::vector<std::string> flags;
  AddFlags(app, &flags);
  const CLI::App* within = &app;
  int first = 1;
  if (!command.empty()) {
    within = app.get_subcommand(command);
    AddFlags(*within, &flags);
    const std::vector<std::string> deeper = CommandNames(*within);
    first = 2;
    if (argc > 2 && std::ranges::find(deeper, argv[2]) != deeper.end()) {
      AddFlags(*within->get_subcommand(argv[2]), &flags);
      first = 3;
    }
  }
  for (int i = first; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string flag = std::string(argv[i]).substr(0, std::string_view(argv[i]).find('='));
    if (!flag.starts_with("--") || std::ranges::find(flags, flag) != flags.end()) continue;
    const std::string nearest = NearestFlag(flag, flags);
    return "there is no option '" + flag + "'" + (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
  }
  return "";
}

int UsageError(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  const std::vector<std::string> commands = CommandNames(app);
  const bool known = std::ranges::find(commands, word) != commands.end();
  if (argc > 1 && !known && !word.starts_with('-')) {
    Complain("there is no command '" + word + "'" + Suggest(word, commands));
  } else if (const std::string what = UnknownSubcommand(app, known ? word : "", argc, argv); !what.empty()) {
    Complain(what);
  } else if (argc == 1) {
    std::fputs(app.help().c_str(), stderr);
  } else if (const std::string flag = UnknownFlag(app, known ? word : "", argc, argv); !flag.empty()) {
    Complain(flag + " (cairn " + (known ? word + " " : "") + "--help lists them)");
  } else {
    Complain(std::string(error.what()) + " (cairn " + (known ? word + " " : "") + "--help says more)");
  }
  return kExitBadInput;
}

// What is sent to a service is text, in UTF-8; protobuf lets other bytes out, and no service takes them in.
void RefuseOtherBytes(const CLI::App& command, int argc, char** argv) {
  if (command.get_option_no_throw("--connect") == nullptr) return;
  for (int i = 1; i < argc; ++i)
    if (const std::string wrong = WhatIsWrongWithText(argv[i]); !wrong.empty())
      throw InputError("'" + std::string(argv[i]) + "' " + wrong);
}

int RunCaught(const Invocation& call) {
  try {
    Check(PrepareProcess({}));
    return call.run();
  } catch (const InputError& error) {
    Complain(error.what());
    return kExitBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    // A name that no file can have, a folder that nobody may look into.
    const Status status = SystemFailure(error.path1(), "cannot be used", error.code().value());
    Complain(status.message());
    if (!IsTheWorldsFault(status)) return kExitBadInput;
  } catch (const std::bad_alloc&) {
    Complain("out of memory");
  } catch (const std::exception& error) {
    Complain(error.what());
  }
  return kExitFailed;
}

// The pipeline that `cairn run PIPELINE --help` asks about; empty where it asks about the command.
std::string PipelineAskedAbout(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i)
    if (const std::string_view word = argv[i]; word != "--help" && word != "-h") words.emplace_back(word);
  const bool runs = words.size() > 1 && (words[0] == "run" || words[0] == "submit");
  return runs && !words[1].starts_with('-') && !IsJobFile(words[1]) ? words[1] : "";
}

int SayHelp(const CLI::App& app, const CLI::Success& help, int argc, char** argv) {
  const std::string pipeline = PipelineAskedAbout(argc, argv);
  const bool asked = dynamic_cast<const CLI::CallForHelp*>(&help) != nullptr;
  if (!asked || pipeline.empty()) return app.exit(help);
  Invocation call;
  call.run = [&pipeline] {
    std::fputs(PipelineText(LoadCatalog().At(pipeline)).c_str(), stdout);
    return kExitDone;
  };
  return RunCaught(call);
}

int ParseAndRun(int argc, char** argv) {
  CLI::App app(
      "Cairn turns robot logs into maps and learned landmarks, the same bits on a laptop or a cluster.",
      "cairn");
  app.set_version_flag("--version", "cairn " CAIRN_VERSION " (" CAIRN_MARCH ")");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "`cairn help COMMAND` and `cairn COMMAND --help` say more.\n"
      "Exit codes: 0 done, 1 failed through no fault of the input, 2 bad usage or input, or an output that\n"
      "cannot be written where it was asked for.\n"
      "Example:\n  cairn simulate loop log.h5 && cairn run landmark_map log.h5 --out result");
  Invocation call;
  app.add_flag("--log-json", call.log_json, "Logs as JSON lines on stderr");
  app.add_flag("-v,--verbose", call.verbose, "Say more about what happens");
  AddCommands(Command(&app), call);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return SayHelp(app, help, argc, argv);
  } catch (const CLI::ParseError& error) {
    return UsageError(app, error, argc, argv);
  }
  call.run = [&app, argc, argv, run = call.run] {
    RefuseOtherBytes(*app.get_subcommands().front(), argc, argv);
    return run();
  };
  return RunCaught(call);
}

}  // namespace

int Main(int argc, char** argv) {
  EscapeOutput();
  // `cairn help run` is `cairn run --help`.
  std::string_view help_flag = "--help";
  std::vector<char*> words(argv, argv + argc);
  if (argc > 1 && std::string_view(argv[1]) == "help") {
    words.erase(words.begin() + 1);
    if (argc == 2 || std::string_view(words.back()) != help_flag)
      words.push_back(const_cast<char*>(help_flag.data()));
    argc = static_cast<int>(words.size());
  }
  words.push_back(nullptr);
  argv = words.data();
  int code = kExitFailed;
  if (argc > 1 && std::string_view(argv[1]) == "worker") {
    Invocation call;
    call.run = [argc, argv] { return BecomeWorker(argc, argv); };
    code = RunCaught(call);
  } else {
    code = ParseAndRun(argc, argv);
  }
  // A full disk may show only when the last facts are written.
  if (!FinishOutput()) {
    Complain("cannot write to the standard output");
    return kExitFailed;
  }
  return code;
}

}  // namespace cairn::cli
