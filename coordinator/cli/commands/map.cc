#include <cstdio>
#include <filesystem>

#include "coordinator/cli/commands/run.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/job_file/arguments.h"
#include "coordinator/cli/job_file/catalog.h"
#include "coordinator/cli/job_file/choose.h"
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

// The job file, its reasons on top. `folder`: where it stands, from which its inputs are named.
std::string JobFileText(const MapArguments& options, ChosenJob chosen, const fs::path& folder) {
  chosen.job.set_seed(options.seed);
  // Both without links, so that `..` means the same by name as on disk.
  const std::string log = fs::canonical(options.log).lexically_relative(fs::canonical(folder));
  if (const std::string wrong = WhatIsWrongWithName(log, kMostTextBytes); !wrong.empty())
    throw InputError("'" + log + "' cannot stand in a job file, for it " + wrong +
                     "; rename it, or `cairn run PIPELINE` of it");
  (*chosen.job.mutable_inputs())["log"] = log;
  std::string text = "# Made by `cairn map` of what the log holds. Change it and `cairn run` it.\n";
  for (const std::string& reason : chosen.reasons) text += "# " + reason + "\n";
  return text + coordinator::JobAsYaml(chosen.job);
}

// The job file is there, as it was chosen.
void WriteJob(const fs::path& path, const std::string& text, bool force) {
  if (!force && fs::exists(fs::symlink_status(path))) {
    if (datasets::ReadText(path.string()) == text) return;
    throw InputError("'" + path.string() +
                     "' is there already and is not what this log asks for; `cairn run " + path.string() +
                     " --out " + path.parent_path().string() + "` runs it as it is, --force writes it anew");
  }
  Check(WriteTextAtomically(path, text));
}

int Map(const MapArguments& options, const Invocation& call) {
  PrepareToRun(options.run.workers);
  const ChosenJob chosen = ChooseJob(ReadLog(options.log));
  if (options.dry_run) {
    std::fputs(JobFileText(options, chosen, ".").c_str(), stdout);
    return kExitDone;
  }
  RunArguments run = options.run;
  if (run.out.empty()) run.out = "map";
  const fs::path job = fs::path(run.out) / "job.yaml";
  std::error_code failed;
  fs::create_directories(run.out, failed);
  if (failed) Throw(SystemFailure(run.out, "cannot be made", failed.value()));
  WriteJob(job, JobFileText(options, chosen, run.out), run.force);
  if (!run.json)
    for (const std::string& reason : chosen.reasons) std::fprintf(stderr, "%s\n", Escaped(reason).c_str());
  return RunJob(run, ResolveJob({.what = job.string()}, LoadCatalog()), call);
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
