#include "coordinator/cli/commands/run_summary.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "coordinator/cli/commands/report.h"
#include "coordinator/cli/common/failure.h"
#include "schema/kinds/kind.h"
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
  // Why none of them tells how good a result is; empty: they may.
  const std::string& wrong_truth() const { return wrong_truth_; }

 private:
  BlobPtr Named(const std::string& name) {
    BlobPtr& blob = known_[name];
    const auto input = parsed_.inputs.find(name);
    if (!blob && input != parsed_.inputs.end()) blob = std::make_shared<const Blob>(Read(input->second.path));
    return blob;
  }

  // What the job took in of it has been checked; its truth has not.
  Blob Read(const std::string& path) {
    BlobFile file = Take(ReadBlobFile(path, {.only = {}, .without = {}, .changed_too = true}));
    try {
      CheckKind(file.blob, file.kind);
      return std::move(file.blob);
    } catch (const InputError& error) {
      wrong_truth_ = error.what();
      return file.blob.Without("truth/");
    }
  }

  const ParsedJob& parsed_;
  std::map<std::string, BlobPtr> known_;
  std::string wrong_truth_;
};

StageSummary Summary(const ScoredStage& stage, const std::string& file, const std::string& picture) {
  StageSummary summary{.stage = stage.name, .kind = stage.kind, .result = file, .picture = picture};
  const datasets::ResultKind* row = datasets::FindResultKind(stage.kind);
  if (row == nullptr) return summary;
  summary.is_map = row->is_map;
  if (row->verdict != nullptr) summary.verdict = row->verdict(*stage.result);
  if (row->summary == nullptr) return summary;
  summary.found = row->summary(*stage.result);
  if (stage.evaluated) summary.evaluation = MakeScores(*stage.evaluated);
  return summary;
}

nlohmann::ordered_json ToJson(const StageSummary& stage, const std::string& report) {
  nlohmann::ordered_json json = {{"stage", stage.stage}, {"kind", stage.kind}, {"result", stage.result}};
  if (!stage.picture.empty()) json["picture"] = stage.picture;
  if (stage.verdict) json["verdict"] = VerdictJson(*stage.verdict);
  if (!stage.found) return json;
  json["map"] = stage.result;
  json["report"] = report;
  json.update(nlohmann::ordered_json::parse(stage.found->ToJson()));
  json["evaluation"] = nullptr;
  if (stage.evaluation) json["evaluation"] = nlohmann::ordered_json::parse(stage.evaluation->ToJson());
  return json;
}

// What was found, how sure it is, how good it is.
std::string FoundText(const StageSummary& stage) {
  constexpr std::size_t kColumn = 11;
  std::string text = stage.found ? stage.found->ToText(kColumn) : "";
  if (stage.verdict) text += "verdict    " + stage.verdict->Text() + "\n";
  if (stage.evaluation) text += "\nagainst the log's ground truth:\n" + stage.evaluation->ToText();
  return text;
}

std::string ResultLines(const StageSummary& stage) {
  std::string text = (stage.is_map ? "map        " : "result     ") + stage.result + "\n";
  if (!stage.picture.empty()) text += "picture    " + stage.picture + "\n";
  return text;
}

}  // namespace

nlohmann::ordered_json VerdictJson(const datasets::Verdict& verdict) {
  nlohmann::ordered_json json = {{"trust", Word(verdict.trust)}, {"why", verdict.why}};
  for (const auto& [name, number] : verdict.numbers) json[name] = number;
  return json;
}

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
    if (!sources.wrong_truth().empty()) summary.unscored[stage.name()] = sources.wrong_truth();
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
  if (!report.empty()) text += "report     " + report + "\n";
  for (const auto& [stage, why] : unscored) text += "not scored: " + stage + ": " + why + "\n";
  const auto tells = [](const StageSummary& s) { return s.found.has_value() || s.verdict.has_value(); };
  const auto tellers = std::ranges::count_if(stages, tells);
  for (const StageSummary& stage : stages) {
    if (!tells(stage)) continue;
    if (tellers > 1) text += "\n" + stage.stage + "\n";
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
