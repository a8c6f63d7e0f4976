#include "coordinator/cli/report.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/invocation.h"
#include "coordinator/cli/output_path.h"
#include "coordinator/cli/result_file.h"
#include "datasets/report/report.h"
#include "schema/store/atomic_file.h"

namespace cairn::cli {
namespace {

struct Options {
  std::string result;
  std::string log;
  std::string out;
  bool force = false;
};

// Beside the result, where nothing else is said.
std::string DefaultOut(const std::string& result_file) {
  return (std::filesystem::path(result_file).parent_path() / "report.html").string();
}

bool HasNetworks(const std::string& result) {
  if (std::filesystem::is_regular_file(result)) return Take(ListBlobFile(result)).kind == "networks";
  return std::ranges::any_of(
      FilesOf(result), [](const std::string& file) { return Take(ListBlobFile(file)).kind == "networks"; });
}

int ReportNetworks(const Options& options) {
  if (!options.log.empty()) throw InputError("--log: networks are not made from a log");
  const std::string file = ResultPath(options.result, "networks");
  const Blob result = ReadResult(file, "networks").blob;
  const std::string out = options.out.empty() ? DefaultOut(file) : options.out;
  RefuseToOverwrite(out, options.force);
  Check(WriteTextAtomically(
      out, datasets::NetworksReportHtml(result, std::filesystem::path(file).stem().string())));
  std::printf("%s\n", out.c_str());
  return kExitDone;
}

int Report(const Options& options, const Invocation&) {
  if (HasNetworks(options.result)) return ReportNetworks(options);
  const std::string file = ResultPath(options.result, "landmark_map");
  const Blob result = ReadResult(file, "landmark_map").blob;
  const std::string out = options.out.empty() ? DefaultOut(file) : options.out;
  RefuseToOverwrite(out, options.force);
  std::optional<Blob> log;
  if (!options.log.empty()) log = ReadResult(options.log, "log").blob;
  std::optional<datasets::Evaluation> evaluation;
  if (log && HasTruth(*log)) evaluation = datasets::Evaluate(result, *log);
  WriteReport(out, std::filesystem::path(file).stem().string(), result, log ? &*log : nullptr,
              evaluation ? &*evaluation : nullptr);
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
  command->add_option("--log", options->log, "The log that it was made from: adds raw odometry, and truth");
  command->add_option("--out", options->out, "The page to write (report.html beside the result)");
  command->add_flag("--force", options->force, "Replace the page where it is there already");
}

}  // namespace cairn::cli
