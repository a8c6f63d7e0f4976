#include "coordinator/cli/commands/run.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include "coordinator/cli/commands/first_stage.h"
#include "coordinator/cli/commands/on_slurm.h"
#include "coordinator/cli/commands/run_summary.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/common/run_page.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/cli/job_file/arguments.h"
#include "coordinator/cli/job_file/inputs.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/cli/output/pages.h"
#include "coordinator/cli/output/plan_text.h"
#include "coordinator/core/job.h"
#include "coordinator/local/embedded.h"
#include "schema/process_limits.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

struct RunCommandArguments {
  JobArguments job;
  RunArguments run;
  bool dry_run = false;
  std::string on;                   // an engine; empty: here
  std::vector<std::string> sbatch;  // with it
};

int ExitCode(coordinator::EmbeddedEnd end) {
  using coordinator::EmbeddedEnd;
  switch (end) {
    case EmbeddedEnd::kDone:
    case EmbeddedEnd::kAlreadyDone:
      return kExitDone;
    case EmbeddedEnd::kInputError:
    case EmbeddedEnd::kConflict:
    case EmbeddedEnd::kBusy:
      return kExitBadInput;
    case EmbeddedEnd::kStopped:
      return kExitStopped;
    case EmbeddedEnd::kFailed:
    case EmbeddedEnd::kPaused:
      break;
  }
  return kExitFailed;
}

void Explain(const coordinator::EmbeddedResult& result, const std::string& out) {
  using coordinator::EmbeddedEnd;
  std::string text = result.reason;
  if (result.end == EmbeddedEnd::kStopped) text = "stopped; the same command again goes on from here";
  if (result.end == EmbeddedEnd::kPaused) text += "; the same command again goes on from here";
  if (result.end == EmbeddedEnd::kConflict) text += " (--force starts anew in " + out + ")";
  std::fprintf(stderr, "cairn: %s\n", text.c_str());
}

int DryRun(bool json, const proto::Job& job, const std::map<std::string, BlobPtr>& inputs,
           const Catalog& catalog) {
  const coordinator::EmbeddedResult planned = PlanFirstStage(job, inputs, StopOnSignals());
  if (planned.end != coordinator::EmbeddedEnd::kStopped && planned.end != coordinator::EmbeddedEnd::kDone) {
    Explain(planned, "");
    return ExitCode(planned.end);
  }
  const Plan plan{job, inputs, catalog, planned.info.note(), planned.expected};
  std::fputs((json ? PlanJson(plan) : PlanText(plan)).c_str(), stdout);
  return kExitDone;
}

std::vector<std::string> StageNames(const proto::Job& job) {
  std::vector<std::string> names;
  for (const proto::Stage& stage : job.stages()) names.push_back(stage.name());
  return names;
}

// Not even --force puts a result in the place of what it is made from.
void CheckResultsReplaceNoInput(const std::string& dir, const std::vector<std::string>& stages,
                                const ParsedJob& parsed) {
  for (const auto& [name, input] : parsed.inputs) {
    for (const std::string& stage : stages) {
      const std::string result = dir + "/" + stage + ".h5";
      std::error_code ignored;  // of files that are not there: not the same
      if (std::filesystem::equivalent(result, input.path, ignored))
        throw InputError(input.where + ": the result of stage '" + stage + "' would take its place in '" +
                         dir + "'; name another folder");
    }
  }
}

// `cairn map` leaves it beside its results, and what a person has changed in it stays.
void NoteJobFileOfBefore(const std::string& what, const std::string& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored) || std::filesystem::equivalent(what, file, ignored)) return;
  std::fprintf(stderr,
               "note: '%s' is of what was there before; the job that was run now stands in its results "
               "(provenance/job_yaml)\n",
               Escaped(file).c_str());
}

int Run(const RunCommandArguments& options, const Invocation& call) {
  if (!options.on.empty() && !options.dry_run) {
    const std::string name = ResolveJob(options.job, LoadCatalog()).job.name();
    return RunOnSlurm({.job = options.job,
                       .out = options.run.out.empty() ? name : options.run.out,
                       .workers = options.run.workers,
                       .sbatch = options.sbatch,
                       .force = options.run.force});
  }
  PrepareToRun(options.run.workers);
  const Catalog catalog = LoadCatalog();
  ParsedJob parsed = ResolveJob(options.job, catalog);
  RunArguments run = options.run;
  run.units_are_right = options.job.units_are_right;
  if (!options.dry_run) {
    const std::string dir = run.out.empty() ? parsed.job.name() : run.out;
    const int code = RunJob(run, std::move(parsed), call);
    if (run.force) NoteJobFileOfBefore(options.job.what, dir + "/job.yaml");
    return code;
  }
  const std::map<std::string, BlobPtr> inputs = ReadJobInputs(parsed, run.units_are_right);
  return DryRun(run.json, parsed.job, inputs, catalog);
}

}  // namespace

int RunArguments::MostWorkers() {
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

void PrepareToRun(int workers) {
  const auto processes = static_cast<std::uint64_t>(std::max(0, workers));
  Check(PrepareProcess({.files = 48 + 4 * processes,
                        .file_bytes = 64 << 20,
                        .memory_bytes = 512 << 20,
                        .threads = 8 + 8 * std::min<std::uint64_t>(processes, 64)}));
}

int RunJob(const RunArguments& options, ParsedJob parsed, const Invocation& call,
           const std::function<void()>& beside_results) {
  const std::map<std::string, BlobPtr> inputs = ReadJobInputs(parsed, options.units_are_right);
  coordinator::EmbeddedOptions embedded;
  embedded.dir = options.out.empty() ? parsed.job.name() : options.out;
  embedded.workers = options.workers;
  embedded.worker_program = WorkerProgram();
  embedded.task_memory_mb = options.task_memory_mb;
  embedded.checkpoint_interval_s = options.checkpoint_interval_s;
  embedded.checkpoint_rounds = options.checkpoint_rounds;
  embedded.force = options.force;
  for (const auto& [name, input] : parsed.inputs) embedded.input_files.push_back(input.path);
  const std::vector<std::string> stages = StageNames(parsed.job);
  CheckResultsReplaceNoInput(embedded.dir, stages, parsed);
  if (!options.force) CheckPagesAreOurs(embedded.dir, stages, std::nullopt);
  Console console(call);
  embedded.log = console.Sink();
  std::optional<RunPage> page;
  if (options.page)
    embedded.when_listening = [&](const std::string& endpoint) { page.emplace(endpoint, embedded.dir); };
  RunSummary summary;
  embedded.when_done = [&](const coordinator::EmbeddedResult& done) {
    console.Clear();
    if (beside_results) beside_results();
    summary = Summarize(parsed, embedded.dir, done.results);
  };
  const coordinator::EmbeddedResult result = coordinator::RunEmbedded(
      embedded, parsed.job, inputs,
      [&](const coordinator::EmbeddedProgress& progress) { console.Progress(progress.info); },
      StopOnSignals());
  console.Clear();
  const int code = ExitCode(result.end);
  if (code != kExitDone) {
    Explain(result, embedded.dir);
    return code;
  }
  if (result.end == coordinator::EmbeddedEnd::kAlreadyDone)
    summary.note = "finished already; nothing was run";
  if (result.resumed) summary.note = "resumed where it was";
  std::fputs(options.json ? summary.Json().c_str() : summary.Text().c_str(), stdout);
  return kExitDone;
}

void AddRunArguments(Command command, RunArguments& arguments) {
  command.Add("--workers", arguments.workers, "Worker processes (as many as there are cores)")
      .Within(1, 1024);
  command
      .Add("--task-memory-mb", arguments.task_memory_mb,
           "Memory that a task may take beside its inputs; the job's own limit counts where it is lower")
      .Within(std::uint64_t{1}, coordinator::kMostTaskMemory_mb);
  command
      .Add("--checkpoint-interval", arguments.checkpoint_interval_s,
           "Seconds between checkpoints, from which a run that is killed goes on")
      .Within(0.0, 3600.0)
      .ShowDefault();
  command
      .Add("--checkpoint-rounds", arguments.checkpoint_rounds,
           "A checkpoint every so many rounds, instead of by seconds (0: by seconds)")
      .Within(std::uint64_t{0}, std::uint64_t{1'000'000'000});
  command.AddFlag("--force", arguments.force, "Forget what an earlier run left in the folder");
  command.AddFlag("--json", arguments.json, "The summary, or the plan, as JSON");
  command.AddFlag("--page", arguments.page,
                  "Show it in a browser while it runs, to whoever opens the link that is printed");
}

void AddRun(Command app, Invocation& call) {
  Command command;
  const auto options = AddCommand<RunCommandArguments>(
      app, call, "run", "Runs a job here, on workers of its own; the same command again resumes it",
      "cairn run job.yaml --out result\n  cairn run landmark_map log.h5 --set cell_m=0.5 --out map "
      "--workers 4",
      Run, &command);
  AddJobArguments(command, options->job);
  command.Add("--out", options->run.out, "Folder of the results (the job's name)");
  AddRunArguments(command, options->run);
  const Argument on =
      command
          .Add("--on", options->on, "Elsewhere: slurm makes a batch job of it, whose workers are jobs, too")
          .OneOf({"slurm"});
  command
      .Add("--sbatch", options->sbatch,
           "With --on slurm an option of sbatch's, --sbatch=--time=8:00:00; again for another")
      .OneEachTime()
      .Needs(on);
  command.AddFlag("--dry-run", options->dry_run,
                  "Check everything, plan the first stage, print the plan with estimates, run nothing");
}

}  // namespace cairn::cli
