#include "coordinator/cli/report.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/invocation.h"
#include "coordinator/cli/output_path.h"
#include "coordinator/cli/pages.h"
#include "coordinator/cli/result_file.h"
#include "datasets/report/report.h"
#include "schema/store/atomic_file.h"

namespace cairn::cli {
namespace {

struct Options {
  bool changed = false;
  std::string result;
  std::string log;
  std::string out;
  bool force = false;
};

// Beside the result, where nothing else is said.
std::string DefaultOut(const std::string& result_file) {
  return (std::filesystem::path(result_file).parent_path() / "report.html").string();
}

// What there is to report on: the kind of the file, or of a folder's files the first of these.
std::string KindOf(const std::string& result) {
  if (std::filesystem::is_regular_file(result)) return Take(ListBlobFile(result)).kind;
  std::vector<std::string> kinds;
  for (const std::string& file : FilesOf(result)) kinds.push_back(Take(ListBlobFile(file)).kind);
  for (const char* kind : {"networks", "localization", "landmark_map", "grid_map", "local_map"}) {
    if (std::ranges::find(kinds, kind) != kinds.end()) return kind;
  }
  return "landmark_map";
}

std::string PageOfMap(const std::string& title, const Blob& result, const Options& options) {
  std::optional<Blob> log;
  if (!options.log.empty()) log = ReadResult(options.log, "log", options.changed).blob;
  std::optional<datasets::Evaluation> evaluation;
  if (log && HasTruth(*log)) evaluation = datasets::Evaluate(result, *log);
  return datasets::ReportHtml(result, log ? &*log : nullptr, evaluation ? &*evaluation : nullptr, {title});
}

std::string PageOfGrid(const std::string& title, const Blob& map, const Options& options) {
  std::optional<Blob> log;
  if (!options.log.empty()) log = ReadResult(options.log, "log", options.changed).blob;
  std::optional<datasets::GridEvaluation> evaluation;
  if (log) evaluation = datasets::EvaluateGrid(map, *log);
  return datasets::GridMapReportHtml(map, log ? &*log : nullptr, evaluation ? &*evaluation : nullptr, title);
}

std::string PageOfLocal(const std::string& title, const Blob& result, const Options& options) {
  std::optional<Blob> log;
  if (!options.log.empty()) log = ReadResult(options.log, "log", options.changed).blob;
  std::optional<datasets::LocalEvaluation> evaluation;
  if (log && HasTruth(*log)) evaluation = datasets::EvaluateLocal(result, *log);
  return datasets::LocalMapReportHtml(result, log ? &*log : nullptr, evaluation ? &*evaluation : nullptr,
                                      title);
}

std::string PageOf(const std::string& kind, const std::string& file, const Options& options) {
  const std::string title = std::filesystem::path(file).stem().string();
  const Blob result = ReadResult(file, kind, options.changed).blob;
  if (kind == "networks") return datasets::NetworksReportHtml(result, title);
  if (kind == "landmark_map") return PageOfMap(title, result, options);
  if (kind == "grid_map") return PageOfGrid(title, result, options);
  if (kind == "local_map") return PageOfLocal(title, result, options);
  std::optional<Blob> samples;
  if (!options.log.empty()) samples = ReadResult(options.log, "samples", options.changed).blob;
  return datasets::LocalizationReportHtml(result, samples ? &*samples : nullptr, title);
}

int Report(const Options& options, const Invocation&) {
  const std::string found = KindOf(options.result);
  const bool known =
      found == "networks" || found == "localization" || found == "grid_map" || found == "local_map";
  const std::string kind = known ? found : "landmark_map";
  if (kind == "networks" && !options.log.empty()) throw InputError("--log: networks are not made from a log");
  const std::string file = ResultPath(options.result, kind);
  const std::string out = options.out.empty() ? DefaultOut(file) : options.out;
  RefuseToOverwrite(out, options.force);
  Check(WriteTextAtomically(out, PageOf(kind, file, options)));
  RememberPage(out);
  std::printf("%s\n", out.c_str());
  return kExitDone;
}

}  // namespace

bool HasTruth(const Blob& log) { return !log.Sub("truth/").fields().empty(); }

void WriteReport(const std::string& path, const std::string& title, const Blob& result, const Blob* log,
                 const datasets::Evaluation* evaluation) {
  datasets::ReportOptions options;
  options.title = title;
  Check(WriteTextAtomically(path, datasets::ReportHtml(result, log, evaluation, options)));
}

void AddReport(CLI::App& app, Invocation& call) {
  CLI::App* command = nullptr;
  const auto options =
      AddCommand<Options>(app, call, "report", "One self-contained HTML page about a result",
                          "cairn report result --log log.h5 --out page.html", Report, &command);
  command->add_option("RESULT", options->result, "A result file, or the folder given as --out")->required();
  command->add_option("--log", options->log,
                      "The log that it was made from: adds raw odometry, and truth; of a "
                      "localization the samples: adds errors; of a grid_map adds scores");
  command->add_option("--out", options->out, "The page to write (report.html beside the result)");
  AddChangedFlag(*command, &options->changed);
  command->add_flag("--force", options->force, "Replace the page where it is there already");
}

}  // namespace cairn::cli
