// cairn submit: a job, or one of each file of a fleet.
#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/commands/first_stage.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/job_file/arguments.h"
#include "coordinator/cli/job_file/inputs.h"
#include "coordinator/cli/output/job_text.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

struct SubmitArguments {
  ClientArguments client;
  JobArguments arguments;
  std::string each;  // a pattern of files
  std::optional<int> priority;
  bool json = false;
};

// Sorted.
std::vector<std::string> Matches(const std::string& pattern) {
  glob_t found{};
  const int failed = ::glob(pattern.c_str(), GLOB_MARK, nullptr, &found);
  std::vector<std::string> files;
  for (std::size_t i = 0; failed == 0 && i < found.gl_pathc; ++i)
    if (!std::string_view(found.gl_pathv[i]).ends_with('/')) files.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  if (files.empty()) throw InputError("no file matches '" + pattern + "'");
  return files;
}

// The input in whose place each file comes: the pipeline's main one; of a job file its only one, or `log`.
std::string EachInput(const std::string& what, const ParsedJob& parsed, const Catalog& catalog) {
  if (!IsJobFile(what)) return MainInput(catalog.At(what));
  if (parsed.inputs.size() == 1) return parsed.inputs.begin()->first;
  if (!parsed.inputs.contains("log"))
    throw InputError(what + ": --each needs a job of one input, or one that is called 'log'");
  return "log";
}

// The job of one file: it is called after it too.
ParsedJob JobOfFile(const SubmitArguments& options, const Catalog& catalog, const std::string& file) {
  JobArguments arguments = options.arguments;
  if (!arguments.file.empty())
    throw InputError("--each names the files; '" + arguments.file + "' is one too many");
  if (!IsJobFile(arguments.what)) arguments.file = file;
  ParsedJob parsed = ResolveJob(arguments, catalog);
  const std::string input = EachInput(arguments.what, parsed, catalog);
  parsed.inputs.at(input) = {file, "the " + input};
  (*parsed.job.mutable_inputs())[input] = file;
  parsed.job.set_name(parsed.job.name() + "-" + std::filesystem::path(file).stem().string());
  return parsed;
}

// What would end a fleet's submission halfway: throws where a file cannot be an input, with what is wrong
// with each.
void CheckFleet(const std::vector<ParsedJob>& jobs, bool units_are_right) {
  constexpr std::size_t kMostNamed = 10;
  std::vector<std::string> wrong;
  for (const ParsedJob& job : jobs) {
    try {
      CheckFirstStage(job, units_are_right);
    } catch (const InputError& error) {
      wrong.emplace_back(error.what());
    }
  }
  if (wrong.empty()) return;
  std::string text = "nothing is submitted, for " + std::to_string(wrong.size()) + " of " +
                     std::to_string(jobs.size()) + " files cannot be: ";
  for (std::size_t i = 0; i < std::min(wrong.size(), kMostNamed); ++i)
    text += (i == 0 ? "" : "; ") + wrong[i];
  if (wrong.size() > kMostNamed) text += "; …";
  throw InputError(text);
}

// Empty: who asks may command it.
std::string WhoseItIs(const wire::JobInfo& info) {
  if (!info.foreign()) return "";
  return info.owner().empty() ? ", of an unknown owner" : ", of " + Escaped(OwnerText(info));
}

// In what a job that was there already differs from what was asked for now; empty: in nothing.
std::string WhatItKeeps(const proto::Job& asked, const wire::JobInfo& info) {
  std::string text;
  if (info.state() == "done") return text;
  const auto keeps = [&](const char* what, auto wanted, auto is, const std::string& then) {
    if (wanted == decltype(wanted){} || wanted == is) return;
    text += fmt::format("; its {} stays {}, not {}{}", what, is, wanted, then);
  };
  const std::string anew = " (cairn delete it to submit it anew)";
  keeps("priority", asked.priority(), info.priority(),
        fmt::format(" (cairn priority {} {})", info.id(), asked.priority()));
  keeps("task_time_s", asked.task_time_s(), info.task_time_s(), anew);
  keeps("task_memory_mb", asked.task_memory_mb(), info.task_memory_mb(), anew);
  return text;
}

wire::JobInfo SubmitOne(const SubmitArguments& options, coordinator::Client& client, ParsedJob parsed) {
  if (options.priority) parsed.job.set_priority(*options.priority);
  const std::map<std::string, coordinator::Input> inputs =
      LookAtJobInputs(parsed, options.arguments.units_are_right);
  bool known = false;
  wire::JobInfo info = Take(client.Submit(parsed.job, inputs, &known));
  if (options.json) return info;
  if (known)
    std::printf("already there: %s, %s%s; cairn watch %s%s\n", info.id().c_str(), info.state().c_str(),
                WhoseItIs(info).c_str(), info.id().c_str(), WhatItKeeps(parsed.job, info).c_str());
  else
    std::printf("submitted %s; cairn watch %s\n", info.id().c_str(), info.id().c_str());
  return info;
}

// All is read and checked, as `cairn run --dry-run` does, before the first job is handed in. Where it is cut
// off all the same, it may be said again: the service knows what it has.
int Submit(const SubmitArguments& options, const Invocation&) {
  const Catalog catalog = LoadCatalog();
  std::vector<ParsedJob> jobs;
  if (options.each.empty()) {
    jobs.push_back(ResolveJob(options.arguments, catalog));
    CheckFirstStage(jobs.front(), options.arguments.units_are_right);
  } else {
    for (const std::string& file : Matches(options.each)) jobs.push_back(JobOfFile(options, catalog, file));
    CheckFleet(jobs, options.arguments.units_are_right);
  }
  coordinator::Client client = ConnectClient(options.client);
  std::vector<wire::JobInfo> submitted;
  for (ParsedJob& job : jobs) submitted.push_back(SubmitOne(options, client, std::move(job)));
  if (options.json)
    std::fputs((options.each.empty() ? JobJson(submitted.front()) : JobsJson(submitted)).c_str(), stdout);
  return kExitDone;
}

}  // namespace

void AddSubmit(Command app, Invocation& call) {
  Command command;
  const auto options = AddCommand<SubmitArguments>(
      app, call, "submit", "Hands a job and its inputs to a coordinator",
      "cairn submit job.yaml\n  cairn submit landmark_map --each 'logs/*.h5' --priority -1", Submit,
      &command);
  AddClientArguments(command, options->client);
  AddJobArguments(command, options->arguments);
  command.Add("--each", options->each,
              "A job for each file that matches this pattern, in place of the one that is named");
  command
      .Add("--priority", options->priority,
           "-10 to 10; each step doubles its share of the workers (the job file's, or 0)")
      .Within(-10, 10);
  command.AddFlag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
