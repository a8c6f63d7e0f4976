#include <cstdio>

#include "datasets/evaluate/features.h"
#include "datasets/evaluate/window_scores_print.h"

namespace cairn::datasets {
namespace {

using Json = nlohmann::ordered_json;

Json ShareJson(const std::optional<double>& share) { return share ? Json(*share) : Json(nullptr); }

Json DetectionJson(const Detection& d) {
  return {{"detector", d.detector},          {"truth", d.truth},    {"precision", ShareJson(d.precision())},
          {"recall", ShareJson(d.recall())}, {"both", d.both},      {"only_detected", d.only_detected},
          {"only_true", d.only_true},        {"neither", d.neither}};
}

std::string ShareText(const std::optional<double>& share) {
  if (!share) return "unknown";
  char text[32];
  std::snprintf(text, sizeof text, "%.1f%%", 100 * *share);
  return text;
}

std::string DetectionText(const Detection& d) {
  return "detector   '" + d.detector + "' of '" + d.truth + "': precision " + ShareText(d.precision()) +
         ", recall " + ShareText(d.recall()) + ", of " +
         std::to_string(d.both + d.only_detected + d.only_true + d.neither) + " samples\n";
}

std::string RunsText(const FeatureEvaluation& evaluation) {
  std::vector<std::string> names;
  std::int64_t samples = 0;
  for (const RunSize& run : evaluation.runs) {
    names.push_back(run.name);
    samples += run.samples;
  }
  return "held out   " + std::to_string(samples) + " samples of " + Joined(names) +
         (evaluation.in_turn ? ", one run after the other\n" : "\n");
}

}  // namespace

std::string FeatureEvaluationJson(const FeatureEvaluation& evaluation,
                                  const std::optional<Detection>& detection, int indent) {
  Json runs = Json::array();
  for (const RunSize& run : evaluation.runs) runs.push_back({{"name", run.name}, {"samples", run.samples}});
  Json json = {
      {"features", evaluation.features},
      {"heading_window_deg",
       evaluation.headings ? Json(evaluation.options.heading_window_deg.value_or(180)) : Json(nullptr)},
      {"nearest", evaluation.options.nearest},
      {"samplings", evaluation.options.samplings},
      {"seed", evaluation.options.seed},
      {"in_turn", evaluation.in_turn},
      {"runs", runs},
      {"map_runs", evaluation.map_runs}};
  if (detection) json["detection"] = DetectionJson(*detection);
  json["windows"] = WindowScoresJson(evaluation.windows);
  return json.dump(indent);
}

std::string FeatureEvaluationText(const FeatureEvaluation& evaluation,
                                  const std::optional<Detection>& detection) {
  return "features   " + Joined(evaluation.features) + ", made by hand\n" + RunsText(evaluation) +
         "map        P(f | place) by the " + std::to_string(evaluation.options.nearest) +
         " nearest samples of " +
         (evaluation.in_turn ? std::string("the other runs") : Joined(evaluation.map_runs)) +
         (evaluation.headings ? HeadingText(evaluation.options.heading_window_deg.value_or(180)) : "") +
         "\n" + (detection ? DetectionText(*detection) : "") + WindowScoresText(evaluation.windows);
}

}  // namespace cairn::datasets
