#include "datasets/inspect/inspect.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/commands/folder_jobs.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/result_file.h"
#include "coordinator/cli/output/text_table.h"
#include "datasets/bag/in_child.h"
#include "datasets/import/recognize.h"
#include "datasets/kinds/result_kinds.h"
#include "schema/kinds/kind.h"
#include "schema/store/blob_file.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct InspectArguments {
  std::string file;
  bool json = false;
};

// A file of Cairn's in a folder: its name and its kind.
using Found = std::vector<std::pair<std::string, std::string>>;

bool IsResult(const std::string& kind) {
  const Kind* known = FindKind(kind);
  return known == nullptr || !known->is_given;
}

// Those of which `export csv` makes tables.
bool HasTables(const std::string& kind) {
  const datasets::ResultKind* known = datasets::FindResultKind(kind);
  return known != nullptr && known->exports.find("csv") != std::string_view::npos;
}

// What a person can do with the files of a folder, in the order of doing it.
std::vector<std::string> NextCommands(const std::string& folder, const Found& files) {
  const std::string name = ShellWord(folder);
  std::vector<std::string> commands = {"cairn inspect " + ShellWord(folder + "/" + files.front().first)};
  const bool results = std::ranges::any_of(files, [](const auto& file) { return IsResult(file.second); });
  if (results) {
    commands.push_back("cairn report " + name);
    if (std::ranges::any_of(files, [](const auto& file) { return HasTables(file.second); }))
      commands.push_back("cairn export csv " + name + " " + ShellWord(folder + "-tables"));
  } else {
    commands.push_back("cairn pipelines");
  }
  return commands;
}

std::string Doubtful(const std::string& folder, bool unfinished) {
  if (fs::exists(fs::path(folder) / "jobs.sqlite"))
    return "'" + folder + "' is a coordinator's store; `cairn coordinator --store " + ShellWord(folder) +
           "` serves it, `cairn status` says what is in it";
  return unfinished
             ? "'" + folder +
                   "' is the --out folder of a run that is not finished; the same `cairn run` again goes "
                   "on with it"
             : "'" + folder + "' holds nothing that Cairn knows (docs/my-own-log.md says what it reads)";
}

int InspectFolder(const InspectArguments& options) {
  Found files;
  for (const std::string& file : FilesOf(options.file)) {
    const Result<BlobFileInfo> info = ListBlobFile(file);
    if (info.ok()) files.emplace_back(fs::path(file).filename().string(), info.value().kind);
  }
  const bool run = fs::is_directory(fs::path(options.file) / ".cairn");
  WarnOfSeveralJobs(options.file, "the list shows all of them");
  std::string what;
  std::vector<std::string> commands;
  if (!files.empty()) {
    what = run ? "the --out folder of a run" : "a folder of Cairn files";
    commands = NextCommands(options.file, files);
  } else if (const auto recognized = datasets::Recognize(options.file)) {
    what = recognized->what;
    commands = {recognized->command};
  } else {
    throw InputError(Doubtful(options.file, run));
  }
  if (options.json) {
    nlohmann::ordered_json json = {{"folder", options.file}, {"what", what}};
    json["files"] = nlohmann::ordered_json::array();
    for (const auto& [name, kind] : files) json["files"].push_back({{"name", name}, {"kind", kind}});
    json["commands"] = commands;
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    return kExitDone;
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, kind] : files) rows.push_back({"  " + name, kind});
  std::printf("%s: %s\n%s", options.file.c_str(), what.c_str(), TextTable(rows).c_str());
  for (const std::string& command : commands) std::printf("try: %s\n", command.c_str());
  return kExitDone;
}

// Of a text it says which command reads it.
[[noreturn]] void ThrowForeignFile(const std::string& file, const Status& status) {
  if (const auto recognized = datasets::Recognize(file))
    throw InputError("'" + file + "' looks like " + recognized->what +
                     "; read it in: " + recognized->command);
  Throw(status);
}

// That needs no quotes in a shell.
bool IsPlainName(const std::string& name) {
  return std::ranges::all_of(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' || c == '_'; });
}

std::string BagJson(const std::string& file, const datasets::BagInspection& bag) {
  nlohmann::ordered_json json = {{"file", file},
                                 {"what", bag.what},
                                 {"first_s", bag.first_s},
                                 {"length_s", bag.length_s},
                                 {"remarks", bag.remarks}};
  json["topics"] = nlohmann::ordered_json::array();
  for (const datasets::BagTopic& topic : bag.topics) {
    nlohmann::ordered_json one = {
        {"name", topic.name},       {"type", topic.type}, {"messages", topic.messages},
        {"rate_hz", topic.rate_hz}, {"as", topic.as},     {"frames", topic.frames}};
    if (topic.gap_s) one["gap_s"] = *topic.gap_s;
    json["topics"].push_back(std::move(one));
  }
  json["commands"] = nlohmann::ordered_json::array();
  if (datasets::MakesALog(bag)) json["commands"].push_back(bag.command);
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

int InspectABag(const InspectArguments& options, const std::string& command) {
  const auto tell = [&](datasets::BagInspection bag) {
    bag.command = command;
    for (const datasets::BagTopic& topic : bag.topics)
      if (topic.as.starts_with("landmarks") && IsPlainName(topic.name))
        bag.command += " --landmarks " + topic.name;
    return options.json ? BagJson(options.file, bag) : Escaped(options.file) + ": " + datasets::BagText(bag);
  };
  std::fputs(Take(datasets::InspectBagInChild(options.file, tell)).c_str(), stdout);
  return kExitDone;
}

// The command that reads in a bag, or a folder of rosbag2; empty where it is none.
std::string CommandOfBag(const std::string& path) {
  const auto recognized = datasets::Recognize(path);
  if (!recognized || !recognized->command.starts_with("cairn import bag ")) return {};
  return fs::is_directory(path) && recognized->what != "a folder of rosbag2" ? "" : recognized->command;
}

int Inspect(const InspectArguments& options, const Invocation&) {
  if (const std::string bag = CommandOfBag(options.file); !bag.empty()) return InspectABag(options, bag);
  if (fs::is_directory(options.file)) return InspectFolder(options);
  const Result<datasets::Inspection> inspection = datasets::Inspect(options.file);
  if (!inspection.ok()) ThrowForeignFile(options.file, inspection.status());
  if (inspection.value().changed) WarnOfChanged(options.file);
  std::fputs(
      (options.json ? datasets::InspectJson(inspection.value()) : datasets::InspectText(inspection.value()))
          .c_str(),
      stdout);
  if (const std::string& wrong = inspection.value().wrong; !wrong.empty())
    throw InputError(options.file + ": " + wrong);
  return kExitDone;
}

}  // namespace

void AddInspect(Command app, Invocation& call) {
  Command command;
  const auto options =
      AddCommand<InspectArguments>(app, call, "inspect", "What is in a Cairn file, every checksum looked at",
                                   "cairn inspect log.h5", Inspect, &command);
  command
      .Add("FILE", options->file,
           "A log, a result, a checkpoint; a bag of ROS; of a folder: what it looks like, and which command "
           "reads it")
      .Required();
  command.AddFlag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
