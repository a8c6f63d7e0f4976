#include "datasets/evaluate/networks.h"
#include "datasets/evaluate/window_scores_print.h"

namespace cairn::datasets {
namespace {

using Json = nlohmann::ordered_json;

std::string HeldOutText(const NetworkEvaluation& evaluation) {
  std::vector<std::string> names;
  std::int64_t samples = 0;
  for (const RunSize& run : evaluation.runs) {
    names.push_back(run.name);
    samples += run.samples;
  }
  std::string text = "held out   " + std::to_string(samples) + " samples of " + Joined(names);
  if (!evaluation.trained_on.empty()) text += "; left out, as trained on: " + Joined(evaluation.trained_on);
  if (!evaluation.stopped_by.empty())
    text += "\ncaution    not wholly unseen, as training stopped by it: " + Joined(evaluation.stopped_by);
  return text + "\n";
}

}  // namespace

std::string NetworkEvaluationJson(const NetworkEvaluation& evaluation, int indent) {
  Json runs = Json::array();
  for (const RunSize& run : evaluation.runs) runs.push_back({{"name", run.name}, {"samples", run.samples}});
  const Json json = {{"networks", evaluation.networks},
                     {"training_samples", evaluation.training_samples},
                     {"trained_window_m", WindowJson(evaluation.trained_window_m)},
                     {"heading_window_deg",
                      evaluation.headings ? Json(*evaluation.options.heading_window_deg) : Json(nullptr)},
                     {"nearest", evaluation.options.nearest},
                     {"samplings", evaluation.options.samplings},
                     {"seed", evaluation.options.seed},
                     {"runs", runs},
                     {"trained_on", evaluation.trained_on},
                     {"stopped_by", evaluation.stopped_by},
                     {"windows", WindowScoresJson(evaluation.windows)}};
  return json.dump(indent);
}

std::string NetworkEvaluationText(const NetworkEvaluation& evaluation) {
  std::string text = "networks   " + std::to_string(evaluation.networks) + ", trained for " +
                     WindowText(evaluation.trained_window_m) + " on " +
                     std::to_string(evaluation.training_samples) + " samples\n" + HeldOutText(evaluation) +
                     "map        P(f | place) by the " + std::to_string(evaluation.options.nearest) +
                     " nearest training samples" +
                     (evaluation.headings ? HeadingText(*evaluation.options.heading_window_deg) : "") + "\n" +
                     WindowScoresText(evaluation.windows);
  return text;
}

}  // namespace cairn::datasets
