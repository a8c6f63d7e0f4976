#include "coordinator/cli/run_summary.h"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/report.h"
#include "datasets/confidence.h"
#include "datasets/report/draw_map.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

// The log that a stage was given, with its truth; none where the stage's log is no input of the job.
std::optional<Blob> LogOf(const ParsedJob& parsed, const proto::Stage& stage) {
  const auto source = stage.inputs().find("log");
  if (source == stage.inputs().end()) return std::nullopt;
  const auto input = parsed.inputs.find(source->second);
  if (input == parsed.inputs.end()) return std::nullopt;
  return Take(ReadBlobFile(input->second.path, {.only = {}, .without = {}, .changed_too = true})).blob;
}

void Count(const Blob& map, StageSummary& summary) {
  summary.landmarks = map.at("map/landmark_x_m").size();
  const auto likelihood = map.Get<double>("history/log_likelihood");
  summary.iterations = static_cast<std::int64_t>(likelihood.size());
  if (!likelihood.empty()) summary.log_likelihood = likelihood.back();
}

StageSummary SummarizeStage(const ParsedJob& parsed, const proto::Stage& stage, const std::string& file,
                            const Blob& map, const fs::path& dir) {
  StageSummary summary;
  summary.stage = stage.name();
  summary.map = file;
  summary.picture = (dir / "map.png").string();
  summary.report = (dir / "report.html").string();
  Count(map, summary);
  summary.confidence = datasets::ConfidenceText(map);
  if (datasets::RefinementRefused(map)) summary.refinement_refused = datasets::NotRefined(map);
  const std::optional<Blob> log = LogOf(parsed, stage);
  if (log && HasTruth(*log)) summary.evaluation = datasets::Evaluate(map, *log);
  const Blob* log_or_null = log ? &*log : nullptr;
  const datasets::Evaluation* evaluation = summary.evaluation ? &*summary.evaluation : nullptr;
  fs::create_directories(dir);
  Check(WriteTextAtomically(summary.picture, datasets::DrawMapPng(map, log_or_null, evaluation)));
  WriteReport(summary.report, parsed.job.name(), map, log_or_null, evaluation);
  return summary;
}

nlohmann::ordered_json ToJson(const StageSummary& stage) {
  nlohmann::ordered_json json = {{"stage", stage.stage},         {"map", stage.map},
                                 {"picture", stage.picture},     {"report", stage.report},
                                 {"landmarks", stage.landmarks}, {"iterations", stage.iterations}};
  json["confidence"] = stage.confidence;
  if (!stage.refinement_refused.empty()) json["refinement"] = stage.refinement_refused;
  json["log_likelihood"] = nullptr;
  if (stage.log_likelihood) json["log_likelihood"] = *stage.log_likelihood;
  json["evaluation"] = nullptr;
  if (stage.evaluation) {
    json["evaluation"] = nlohmann::ordered_json::parse(datasets::EvaluationJson(*stage.evaluation));
  }
  return json;
}

std::string ToText(const StageSummary& stage) {
  std::string text =
      "map       " + stage.map + "\npicture   " + stage.picture + "\nreport    " + stage.report + "\n";
  char line[160];
  std::snprintf(line, sizeof line, "found     %lld landmark%s in %lld iteration%s, log-likelihood %.1f\n",
                static_cast<long long>(stage.landmarks), stage.landmarks == 1 ? "" : "s",
                static_cast<long long>(stage.iterations), stage.iterations == 1 ? "" : "s",
                stage.log_likelihood.value_or(0));
  text += line + ("confidence " + stage.confidence) + "\n";
  if (!stage.refinement_refused.empty()) text += "refinement " + stage.refinement_refused + "\n";
  if (stage.evaluation)
    text += "\nagainst the log's ground truth:\n" + datasets::EvaluationText(*stage.evaluation);
  return text;
}

}  // namespace

RunSummary Summarize(const ParsedJob& parsed, const std::string& dir,
                     const std::map<std::string, std::string>& results) {
  RunSummary summary;
  std::string last;  // the last landmark map is what people look for
  for (const proto::Stage& stage : parsed.job.stages()) {
    if (Take(ListBlobFile(results.at(stage.name()))).kind == "landmark_map") last = stage.name();
  }
  for (const proto::Stage& stage : parsed.job.stages()) {
    const std::string& file = results.at(stage.name());
    const BlobFile result = Take(ReadBlobFile(file));
    if (result.kind != "landmark_map") {
      summary.other_results[stage.name()] = file;
      continue;
    }
    const fs::path folder = stage.name() == last ? fs::path(dir) : fs::path(dir) / stage.name();
    summary.stages.push_back(SummarizeStage(parsed, stage, file, result.blob, folder));
  }
  return summary;
}

std::string RunSummary::Text() const {
  std::string text = note.empty() ? "" : note + "\n";
  for (const auto& [stage, file] : other_results) text += "result    " + file + "\n";
  for (const StageSummary& stage : stages) text += ToText(stage);
  return text;
}

std::string RunSummary::Json() const {
  nlohmann::ordered_json json = {{"note", note}, {"stages", nlohmann::ordered_json::array()}};
  for (const StageSummary& stage : stages) json["stages"].push_back(ToJson(stage));
  for (const auto& [stage, file] : other_results) json["other_results"][stage] = file;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace cairn::cli
