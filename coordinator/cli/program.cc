#include "coordinator/cli/program.h"

#include <sys/prctl.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <sstream>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/suggest.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/cli/output/output.h"
#include "schema/build_info.h"
#include "schema/command_line/renamed.h"
#include "schema/process_limits.h"
#include "schema/store/atomic_file.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

void Complain(std::string problem) {
  while (!problem.empty() && problem.back() == '\n') problem.pop_back();
  std::fprintf(stderr, "cairn: %s\n", problem.c_str());
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
  return app.get_name() + " " + command + ": there is no '" + word + "'" + Suggest(word, known);
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

// "import csv ", the command that is meant and the one below it, as far as there are such.
std::string CommandWords(const CLI::App& app, int argc, char** argv) {
  std::string words;
  const CLI::App* within = &app;
  for (int i = 1; i < argc && i < 3; ++i) {
    const std::vector<std::string> commands = CommandNames(*within);
    if (std::ranges::find(commands, argv[i]) == commands.end()) break;
    within = within->get_subcommand(argv[i]);
    words += std::string(argv[i]) + " ";
  }
  return words;
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
    Complain(flag + " (" + app.get_name() + " " + CommandWords(app, argc, argv) + "--help lists them)");
  } else {
    // Where there may be several inputs the ending tells which name is the output's.
    const std::string said = error.what();
    const bool output = said == "OUT.h5 is required";
    Complain(said + (output ? ": the file to write, whose name ends in .h5" : "") + " (" + app.get_name() +
             " " + CommandWords(app, argc, argv) + "--help says more)");
  }
  return kExitBadInput;
}

// What is sent to a service is text, in UTF-8; protobuf lets other bytes out, and no service takes them in.
void CheckArgumentBytes(const CLI::App& command, int argc, char** argv) {
  if (command.get_option_no_throw("--connect") == nullptr) return;
  for (int i = 1; i < argc; ++i)
    if (const std::string wrong = WhatIsWrongWithText(argv[i]); !wrong.empty())
      throw InputError("'" + std::string(argv[i]) + "' " + wrong);
}

int RunCaught(const Invocation& call) {
  const auto complain = [&call](const std::string& problem) {
    if (!call.log_json) return Complain(problem);
    Console(call).Log(Console::Level::kError, problem);
  };
  try {
    Check(PrepareProcess({}));
    return call.run();
  } catch (const InputError& error) {
    complain(error.what());
    return kExitBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    // A name that no file can have, a folder that nobody may look into.
    const Status status = SystemFailure(error.path1(), "cannot be used", error.code().value());
    complain(status.message());
    if (!IsTheWorldsFault(status)) return kExitBadInput;
  } catch (const std::bad_alloc&) {
    complain("out of memory");
  } catch (const std::exception& error) {
    complain(error.what());
  }
  return kExitFailed;
}

int ParseAndRun(const Program& program, int argc, char** argv) {
  CLI::App app(program.purpose, program.name);
  app.set_version_flag("--version", std::string(program.name) +
                                        " " CAIRN_VERSION " (" CAIRN_MARCH ", sources " +
                                        SourcesOfThisBuild() + ")");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      std::string("`") + program.name + " help COMMAND` and `" + program.name +
      " COMMAND --help` say more.\n"
      "Exit codes: 0 done, 1 failed through no fault of the input, 2 bad usage or input, or an output that\n"
      "cannot be written where it was asked for.\n"
      "Example:\n  " +
      program.example);
  Invocation call;
  app.add_option_function<std::string>(
         "--log-format", [&call](const std::string& format) { call.log_json = format == "json"; },
         "Of logs on stderr: text, or json, an object a line")
      ->check(CLI::IsMember({"text", "json"}));
  app.add_flag("-v,--verbose", call.verbose, "Say more about what happens");
  bool die_with_parent = false;
  app.add_flag("--die-with-parent", die_with_parent,
               "End, as by SIGTERM, with the process that started this one");
  program.add_commands(Command(&app), call);
  try {
    Parse(app, argc, argv);
  } catch (const CLI::Success& help) {
    // Of `cairn help nosuch` too.
    const std::string word = argc > 1 ? argv[1] : "-";
    const std::vector<std::string> commands = CommandNames(app);
    const bool known = std::ranges::find(commands, word) != commands.end();
    if (!word.starts_with('-') && (!known || !UnknownSubcommand(app, word, argc, argv).empty())) {
      Complain(known ? UnknownSubcommand(app, word, argc, argv)
                     : "there is no command '" + word + "'" + Suggest(word, commands));
      return kExitBadInput;
    }
    std::ostringstream text;
    const int code = app.exit(help, text);
    std::fputs(text.str().c_str(), stdout);
    return code;
  } catch (const CLI::ParseError& error) {
    return UsageError(app, error, argc, argv);
  }
  if (die_with_parent) {
    std::signal(SIGPIPE, SIG_IGN);  // what is saved then comes before what nobody reads
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  }
  call.run = [&app, argc, argv, run = call.run] {
    CheckArgumentBytes(*app.get_subcommands().front(), argc, argv);
    return run();
  };
  return RunCaught(call);
}

}  // namespace

int RunProgram(const Program& program, int argc, char** argv) {
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
  const std::vector<std::string> now = ArgumentsNow(&words);
  words.push_back(nullptr);
  argv = words.data();
  Invocation instead;
  if (program.instead != nullptr) instead.run = program.instead(argc, argv);
  const int code = instead.run ? RunCaught(instead) : ParseAndRun(program, argc, argv);
  // A full disk may show only when the last facts are written.
  if (!FinishOutput()) {
    Complain("cannot write to the standard output");
    return kExitFailed;
  }
  return code;
}

}  // namespace cairn::cli
