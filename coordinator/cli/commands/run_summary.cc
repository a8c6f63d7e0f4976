#include "coordinator/cli/commands/run_summary.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "coordinator/cli/commands/report.h"
#include "coordinator/cli/common/failure.h"
#include "datasets/common/confidence.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

// What the stages of a job are made from: its inputs, read once each and with their truth, and earlier
// results.
class Sources {
 public:
  explicit Sources(const ParsedJob& parsed) : parsed_(parsed) {}

  void Add(const std::string& stage, const BlobPtr& result) { known_[stage] = result; }

  // The stage's log or samples.
  BlobPtr Of(const proto::Stage& stage) {
    for (const char* name : {"log", "samples"}) {
      const auto source = stage.inputs().find(name);
      if (source != stage.inputs().end()) return Named(source->second);
    }
    return nullptr;
  }

 private:
  BlobPtr Named(const std::string& name) {
    BlobPtr& blob = known_[name];
    const auto input = parsed_.inputs.find(name);
    if (!blob && input != parsed_.inputs.end())
      blob = std::make_shared<const Blob>(
          Take(ReadBlobFile(input->second.path, {.only = {}, .without = {}, .changed_too = true})).blob);
    return blob;
  }

  const ParsedJob& parsed_;
  std::map<std::string, BlobPtr> known_;
};

StageSummary Summary(const ScoredStage& stage, const std::string& file, const std::string& picture) {
  StageSummary summary{.stage = stage.name, .kind = stage.kind, .result = file, .picture = picture};
  if (stage.kind != "landmark_map") return summary;
  const Blob& map = *stage.result;
  summary.landmarks = map.at("map/landmark_x_m").size();
  const auto likelihood = map.Get<double>("history/log_likelihood");
  summary.iterations = static_cast<std::int64_t>(likelihood.size());
  if (!likelihood.empty()) summary.log_likelihood = likelihood.back();
  summary.confidence = datasets::ConfidenceText(map);
  if (datasets::RefinementRefused(map)) summary.refinement_refused = datasets::NotRefined(map);
  summary.evaluation = stage.evaluation;
  return summary;
}

nlohmann::ordered_json ToJson(const StageSummary& stage, const std::string& report) {
  nlohmann::ordered_json json = {{"stage", stage.stage}, {"kind", stage.kind}, {"result", stage.result}};
  if (!stage.picture.empty()) json["picture"] = stage.picture;
  if (stage.kind != "landmark_map") return json;
  json["map"] = stage.result;
  json["report"] = report;
  json["landmarks"] = stage.landmarks;
  json["iterations"] = stage.iterations;
  json["confidence"] = stage.confidence;
  if (!stage.refinement_refused.empty()) json["refinement"] = stage.refinement_refused;
  json["log_likelihood"] = nullptr;
  if (stage.log_likelihood) json["log_likelihood"] = *stage.log_likelihood;
  json["evaluation"] = nullptr;
  if (stage.evaluation) {
    json["evaluation"] = nlohmann::ordered_json::parse(datasets::ScoresOf(*stage.evaluation).ToJson());
  }
  return json;
}

// Of a landmark map: what was found, how sure it is, how good it is.
std::string FoundText(const StageSummary& stage) {
  char line[160];
  std::snprintf(line, sizeof line, "found     %lld landmark%s in %lld iteration%s, log-likelihood %.1f\n",
                static_cast<long long>(stage.landmarks), stage.landmarks == 1 ? "" : "s",
                static_cast<long long>(stage.iterations), stage.iterations == 1 ? "" : "s",
                stage.log_likelihood.value_or(0));
  std::string text = line + ("confidence " + stage.confidence) + "\n";
  if (!stage.refinement_refused.empty()) text += "refinement " + stage.refinement_refused + "\n";
  if (stage.evaluation)
    text += "\nagainst the log's ground truth:\n" + datasets::ScoresOf(*stage.evaluation).ToText();
  return text;
}

std::string ResultLines(const StageSummary& stage) {
  const bool map = stage.kind == "landmark_map" || stage.kind == "grid_map" || stage.kind == "local_map";
  std::string text = (map ? "map       " : "result    ") + stage.result + "\n";
  if (!stage.picture.empty()) text += "picture   " + stage.picture + "\n";
  return text;
}

}  // namespace

RunSummary Summarize(const ParsedJob& parsed, const std::string& dir,
                     const std::map<std::string, std::string>& results) {
  RunSummary summary;
  Sources sources(parsed);
  std::vector<ScoredStage> stages;
  for (const proto::Stage& stage : parsed.job.stages()) {
    BlobFile result = Take(ReadBlobFile(results.at(stage.name())));
    const auto blob = std::make_shared<const Blob>(std::move(result.blob));
    stages.push_back(
        {.name = stage.name(), .kind = result.kind, .result = blob, .source = sources.Of(stage)});
    sources.Add(stage.name(), blob);
    try {
      stages.back().Score();
    } catch (const InputError& error) {  // the run is done all the same
      summary.unscored[stage.name()] = error.what();
    }
  }
  const WrittenPages written = WritePages(dir, stages);
  summary.report = written.report;
  for (std::size_t i = 0; i < stages.size(); ++i)
    summary.stages.push_back(Summary(stages[i], results.at(stages[i].name), written.pictures[i]));
  return summary;
}

std::string RunSummary::Text() const {
  std::string text = note.empty() ? "" : note + "\n";
  for (const StageSummary& stage : stages) text += ResultLines(stage);
  if (!report.empty()) text += "report    " + report + "\n";
  for (const auto& [stage, why] : unscored) text += "not scored: " + stage + ": " + why + "\n";
  std::size_t maps = 0;
  for (const StageSummary& stage : stages) maps += stage.kind == "landmark_map" ? 1 : 0;
  for (const StageSummary& stage : stages) {
    if (stage.kind != "landmark_map") continue;
    if (maps > 1) text += "\n" + stage.stage + "\n";
    text += FoundText(stage);
  }
  return text;
}

std::string RunSummary::Json() const {
  nlohmann::ordered_json json = {
      {"note", note}, {"report", report}, {"stages", nlohmann::ordered_json::array()}};
  for (const StageSummary& stage : stages) json["stages"].push_back(ToJson(stage, report));
  if (!unscored.empty()) json["unscored"] = unscored;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace cairn::cli
