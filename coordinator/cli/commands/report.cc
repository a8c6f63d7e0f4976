#include "coordinator/cli/commands/report.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "coordinator/cli/commands/folder_jobs.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/result_file.h"
#include "coordinator/cli/common/suggest.h"
#include "coordinator/cli/output/pages.h"
#include "coordinator/cli/output/path.h"
#include "datasets/kinds/job_report.h"
#include "schema/kinds/kind.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  bool changed = false;
  std::string result;
  std::string beside;  // another, to be shown with it; empty: none
  std::string log;
  std::string out;
  bool force = false;
  bool json = false;
};

datasets::ReportedStage Reported(const ScoredStage& stage) {
  return {.name = stage.name,
          .result = stage.result.get(),
          .source = stage.source.get(),
          .evaluated = stage.evaluated};
}

bool IsMap(const ScoredStage& stage) {
  const datasets::ResultKind* kind = datasets::FindResultKind(stage.kind);
  return kind != nullptr && kind->is_map;
}

// The stage that people look for: the last of the first kind of map in the table, else the last.
std::size_t MainStage(const std::vector<ScoredStage>& stages) {
  const auto is_main = [&](std::size_t i) { return stages[i].kind == datasets::ResultKinds().front().name; };
  std::size_t main = stages.size() - 1;
  for (std::size_t i = 0; i < stages.size(); ++i)
    if (IsMap(stages[i])) main = i;
  for (std::size_t i = 0; i < stages.size(); ++i)
    if (is_main(i)) main = i;
  return main;
}

// Beside the result, where nothing else is said.
std::string DefaultOut(const ReportArguments& options) {
  const fs::path result = options.result, folder = fs::is_directory(result) ? result : result.parent_path();
  return (folder / (options.beside.empty() ? "report.html" : "comparison.html")).string();
}

// Where in its job's chain a result stands.
std::string StageOf(const Blob& result, const std::string& file) {
  return result.Has("provenance/stage") ? result.Text("provenance/stage") : fs::path(file).stem().string();
}

// The number of the line of the job that names the stage: those of a job in their order.
std::size_t OrderOf(const ScoredStage& stage) {
  if (!stage.result->Has("provenance/job_yaml")) return 0;
  return stage.result->Text("provenance/job_yaml").find("- name: \"" + stage.name + "\"");
}

// The results that a page can show: the file, or all that are right in the folder, those of a job in its
// order. Of `several` jobs each has its file's name too, for stages of two may be called the same.
std::vector<ScoredStage> ReadStages(const std::string& result, bool changed, const BlobPtr& log,
                                    bool several) {
  std::vector<ScoredStage> stages;
  std::vector<std::string> found;
  for (const std::string& file :
       fs::is_directory(result) ? FilesOf(result) : std::vector{ResultPath(result, "")}) {
    const std::string kind = Take(ListBlobFile(file)).kind;
    found.push_back(file + ", " + WithArticle(kind));
    const datasets::ResultKind* row = datasets::FindResultKind(kind);
    if (row == nullptr) continue;
    const auto blob = std::make_shared<const Blob>(ReadFile(file, changed).blob);
    stages.push_back({.name = StageOf(*blob, file),
                      .kind = kind,
                      .result = blob,
                      .source = row->page_takes_source ? log : nullptr});
    if (several) stages.back().name += " (" + fs::path(file).filename().string() + ")";
    stages.back().Score();
  }
  if (stages.empty())
    throw InputError("there is no result in '" + result + "' that has a page" +
                     (found.empty() ? std::string() : ": there is " + Join(found)));
  SortByJob(&stages);
  return stages;
}

// The files that are read for a page.
std::vector<std::string> FilesRead(const ReportArguments& options) {
  std::vector<std::string> inputs{options.log};
  for (const std::string& result : {options.result, options.beside})
    std::ranges::copy(fs::is_directory(result) ? FilesOf(result) : std::vector{result},
                      std::back_inserter(inputs));
  return inputs;
}

// Each stage with the first of the others that is of its kind, of those with its name where there are some.
std::string ComparisonOf(const std::vector<ScoredStage>& stages, std::vector<ScoredStage> others,
                         const ReportArguments& options) {
  std::vector<datasets::ReportedPair> pairs;
  for (const ScoredStage& stage : stages) {
    const auto is_like = [&](const ScoredStage& other) { return other.kind == stage.kind; };
    auto other = std::ranges::find_if(
        others, [&](const ScoredStage& s) { return is_like(s) && s.name == stage.name; });
    if (other == others.end()) other = std::ranges::find_if(others, is_like);
    if (other == others.end()) continue;
    pairs.push_back({Reported(stage), Reported(*other)});
    other->kind.clear();  // it is taken
  }
  if (pairs.empty())
    throw InputError("no result in '" + options.beside + "' is of the kind of one in '" + options.result +
                     "', which is " + WithArticle(stages.front().kind));
  return datasets::ComparisonHtml(pairs, options.result, options.beside);
}

void PrintPage(const std::string& page, const std::vector<ScoredStage>& stages) {
  nlohmann::ordered_json json = {{"file", page}, {"stages", nlohmann::ordered_json::array()}};
  for (const ScoredStage& stage : stages)
    json["stages"].push_back(
        {{"name", stage.name}, {"kind", stage.kind}, {"evaluated", stage.evaluated.has_value()}});
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

int Report(const ReportArguments& options, const Invocation&) {
  for (const std::string& result : {options.result, options.beside})
    if (!result.empty() && !fs::exists(result))
      throw InputError("there is no file or folder '" + result + "'");
  const std::string out = options.out.empty() ? DefaultOut(options) : options.out;
  CheckOutputIsNoInput(out, FilesRead(options));
  CheckOverwrite(out, options.force);
  BlobPtr log;
  if (!options.log.empty()) {
    BlobFile file = ReadFile(options.log, options.changed);
    const auto is_source = [&](const datasets::ResultKind& row) { return row.made_of == file.kind; };
    if (std::ranges::none_of(datasets::ResultKinds(), is_source))
      throw InputError(options.log + ": " + WithArticle(file.kind) + ", where a log or samples are needed");
    log = std::make_shared<const Blob>(std::move(file.blob));
  }
  const std::string several = SeveralJobs(options.result);
  const std::vector<ScoredStage> stages = ReadStages(options.result, options.changed, log, !several.empty());
  if (log && std::ranges::all_of(stages, [](const ScoredStage& stage) { return stage.source == nullptr; }))
    throw InputError("--log: networks are not made from a log");
  WarnOfSeveralJobs(options.result, "the page shows all of them");
  if (options.beside.empty())
    WritePage(out, PageOf(stages, several));
  else
    WritePage(out, ComparisonOf(stages, ReadStages(options.beside, options.changed, log, false), options));
  if (options.json)
    PrintPage(out, stages);
  else
    std::printf("%s\n", out.c_str());
  return kExitDone;
}

}  // namespace

void ScoredStage::Score() {
  const datasets::ResultKind* row = datasets::FindResultKind(kind);
  if (source && row != nullptr && row->has_truth != nullptr && row->has_truth(*source))
    evaluated = row->evaluate(*result, *source, {});
}

void SortByJob(std::vector<ScoredStage>* stages) { std::ranges::stable_sort(*stages, {}, OrderOf); }

std::string PageOf(const std::vector<ScoredStage>& stages, const std::string& note) {
  std::vector<datasets::ReportedStage> reported;
  for (const ScoredStage& stage : stages) {
    if (datasets::FindResultKind(stage.kind) != nullptr) reported.push_back(Reported(stage));
  }
  return reported.empty() ? "" : datasets::JobReportHtml(reported, "", note);
}

WrittenPages WritePages(const fs::path& dir, const std::vector<ScoredStage>& stages) {
  for (const ScoredStage& stage : stages)
    if (const fs::path folder = dir / stage.name; fs::is_symlink(fs::symlink_status(folder)))
      throw InputError("'" + folder.string() +
                       "' is a link, which would lead the pages of a stage elsewhere");
  WrittenPages written;
  std::vector<Page> pages;
  fs::create_directories(dir);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const ScoredStage& stage = stages[i];
    written.pictures.emplace_back();
    if (datasets::FindResultKind(stage.kind) == nullptr) continue;
    const fs::path folder = i == MainStage(stages) ? fs::path() : fs::path(stage.name);
    fs::create_directories(dir / folder);
    const std::string name = (folder / (IsMap(stage) ? "map.png" : "picture.png")).string();
    written.pictures.back() = (dir / name).string();
    pages.push_back({name, datasets::StagePicturePng(Reported(stage))});
  }
  if (std::string page = PageOf(stages); !page.empty()) {
    written.report = (dir / "report.html").string();
    pages.push_back({"report.html", std::move(page)});
  }
  WritePagesOf(dir.string(), stages.empty() ? "" : JobOf(*stages.front().result), pages);
  return written;
}

void AddReport(Command app, Invocation& call) {
  Command command;
  const auto options =
      AddCommand<ReportArguments>(app, call, "report", "One self-contained HTML page about a job's results",
                                  "cairn report result --log log.h5 --out page.html", Report, &command);
  command.Add("RESULT", options->result, "A result file, or the folder given as --out: all that is in it")
      .Required();
  command.Add(
      "--beside", options->beside,
      "Another result, or folder of results: the page (comparison.html) shows both, what differs in scores "
      "and jobs, and their maps, in which one looks around together");
  command.Add("--log", options->log,
              "The log that it was made from: adds raw odometry, and truth; of a "
              "localization the samples: adds errors; of a grid_map adds scores");
  command.Add("--out", options->out, "The page to write (report.html beside the result)");
  AddChangedFlag(command, &options->changed);
  command.AddFlag("--force", options->force, "Replace the page where it is there already");
  command.AddFlag("--json", options->json, "What was written, as JSON");
}

}  // namespace cairn::cli
