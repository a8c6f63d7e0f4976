#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/commands/run.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/job_file/choose.h"
#include "coordinator/cli/output/path.h"
#include "coordinator/store/job_yaml.h"
#include "datasets/common/text_file.h"
#include "datasets/import/recognize.h"
#include "schema/kinds/kind.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct MapArguments {
  std::string log;
  std::uint64_t seed = 0;
  RunArguments run;
  bool dry_run = false;
};

// What people have who have no log of Cairn's yet.
void CheckIsCairns(const std::string& path) {
  const auto raw = datasets::Recognize(path);
  if (raw && !ListBlobFile(path).ok())
    throw InputError("'" + path + "' looks like " + raw->what + "; first make a log of it: " + raw->command);
  if (const std::string why = WhyNoFile(path); !why.empty()) throw InputError(why);
}

Blob ReadLog(const std::string& path) {
  CheckIsCairns(path);
  BlobFile file = Take(ReadBlobFileWithoutTruth(path, true));
  if (file.kind != "log")
    throw InputError(path + ": " + WithArticle(file.kind) + ", where " + IsNeeded("log") +
                     " (`cairn pipelines` says what is made of others)");
  CheckKind(file.blob, file.kind);
  return std::move(file.blob);
}

// The log as the job file in `folder` names it: by where both are without links, so that `..` means the same
// by name as on disk.
std::string NameIn(const fs::path& folder, const std::string& path) {
  const std::string log = fs::canonical(path).lexically_relative(fs::weakly_canonical(fs::absolute(folder)));
  if (const std::string wrong = WhatIsWrongWithName(log, kMostTextBytes); !wrong.empty())
    throw InputError("'" + EscapedName(log) + "' cannot stand in a job file, for it " + wrong +
                     "; rename it, or `cairn run PIPELINE` of it");
  return log;
}

// Its reasons on top.
std::string JobFileText(const ChosenJob& chosen) {
  std::string text = "# Made by `cairn map` of what the log holds. Change it and `cairn run` it.\n";
  for (const std::string& reason : chosen.reasons) text += "# " + reason + "\n";
  return text + coordinator::JobAsYaml(chosen.job);
}

int PrintJob(const ChosenJob& chosen, bool as_json) {
  const std::string text = JobFileText(chosen);
  if (as_json) {
    const nlohmann::ordered_json json = {{"job_file", text}, {"reasons", chosen.reasons}};
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    std::fputs(text.c_str(), stdout);
  }
  return kExitDone;
}

// Whoever has changed the job file wants it run, and not another.
void CheckJobFileIsOurs(const fs::path& path, const std::string& text) {
  if (!fs::exists(fs::symlink_status(path)) || datasets::ReadText(path.string()) == text) return;
  throw InputError("'" + path.string() +
                   "' is there already and says something else (another log or seed, or what you changed); "
                   "`cairn run " +
                   path.string() + " --out ANOTHER` runs it, --force writes it anew");
}

int Map(const MapArguments& options, const Invocation& call) {
  PrepareToRun(options.run.workers);
  ChosenJob chosen = ChooseJob(ReadLog(options.log));
  RunArguments run = options.run;
  if (run.out.empty()) run.out = "map";
  chosen.job.set_seed(options.seed);
  (*chosen.job.mutable_inputs())["log"] = NameIn(options.dry_run ? "." : run.out, options.log);
  if (options.dry_run) return PrintJob(chosen, run.json);
  const fs::path file = fs::path(run.out) / "job.yaml";
  const std::string text = JobFileText(chosen);
  if (IsNoFile(file)) throw InputError("'" + file.string() + "' is a device, a pipe or a socket");
  CheckOutputIsNoInput(file.string(), {options.log});
  if (!run.force) CheckJobFileIsOurs(file, text);
  if (!run.json)
    for (const std::string& reason : chosen.reasons) std::fprintf(stderr, "%s\n", Escaped(reason).c_str());
  ParsedJob parsed{chosen.job, {}};
  parsed.inputs["log"] = {options.log, "the log"};
  return RunJob(run, std::move(parsed), call, [&] { Check(WriteTextAtomically(file, text)); });
}

}  // namespace

void AddMap(Command app, Invocation& call) {
  Command command;
  const auto options = AddCommand<MapArguments>(
      app, call, "map", "Makes a map of a log: looks at what it holds, chooses the pipelines, runs them",
      "cairn map log.h5 --out result\n  cairn map log.h5 --dry-run >job.yaml", Map, &command);
  command.Add("LOG.h5", options->log, "A log (`cairn import` and `cairn simulate` make them)").Required();
  command.Add("--out", options->run.out, "Folder of the results and of the job.yaml that made them (map)");
  AddRunArguments(command, options->run);
  command.AddFlag("--units-are-right", options->run.units_are_right,
                  "Take a log of what no robot does, instead of asking for its units");
  command.Add("--seed", options->seed, "Seed of the job").Check(CheckSeed).ShowDefault();
  command.AddFlag("--dry-run", options->dry_run, "Print the job file with its reasons, run nothing");
}

}  // namespace cairn::cli
