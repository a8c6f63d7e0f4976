#include "pipelines/landmark_learning/result.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "pipelines/landmark_learning/data/ancestry.h"
#include "pipelines/landmark_learning/held_out_check.h"
#include "pipelines/landmark_learning/networks/arrays.h"
#include "schema/kinds/sample_hashes.h"

namespace cairn::landmark_learning {
namespace {

// Of the error, with the space before it.
const char* UnitOf(const Options& options) {
  if (options.error == "squared") return " m²";
  if (options.error == "kl") return " nat";
  return options.error == "table" ? "" : " m";
}

// "name=value" of each option, in the order of options.h.
struct OptionTexts {
  std::vector<std::string> all;

  void Add(const Option& option, const std::string& value) { all.push_back(option.name + ("=" + value)); }
  void operator()(const Option& option, const std::string& value) { Add(option, value); }
  void operator()(const Option& option, const std::int64_t& value) { Add(option, std::to_string(value)); }
  void operator()(const Option& option, const bool& value) { Add(option, value ? "true" : "false"); }
  void operator()(const Option& option, const double& value) {
    std::array<char, 32> text{};  // the shortest that reads back as the same number
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    Add(option, std::string(text.data(), end));
  }
};

}  // namespace

std::string NoteOf(const Options& options, const Training& t) {
  const double error = t.history.last_error(), validation = t.history.last_validation();
  std::string text =
      fmt::format("step {}: error {:.3f}{} of {:.3f}{}, reduced by {:.1f}%", t.steps + 1, error,
                  UnitOf(options), t.prior, UnitOf(options), 100.0 * (1.0 - error / t.prior));
  if (!std::isnan(validation))
    text += fmt::format("; held out {:.1f}%", 100.0 * (1.0 - validation / t.validation_prior));
  return text;
}

Step ResultOf(const Options& options, const TrainingData& data, const Training& t, const HistoryRows& history,
              const Blob* parent, const Blob* starts) {
  const Parameters<float> parameters =
      InFloat(ShapeOf(options, data.mean.size()), t.best.empty() ? t.weights : t.best);
  kinds::Networks of;
  of.networks = WeightsOf(parameters);
  of.networks.input_mean = data.mean;
  of.networks.input_scale = data.scale;
  of.networks.input_name = data.input_names;
  const SampleSet& set = data.training;
  of.map.x_m = set.positions.x_m;
  of.map.y_m = set.positions.y_m;
  of.map.along_m = set.positions.along_m;
  if (!set.heading_rad.empty()) of.map.heading_rad = set.heading_rad;
  of.map.run = set.run;
  of.map.output = {{set.size(), parameters.shape.networks},
                   Forward(parameters, set.inputs(), set.size()).output};
  of.runs = data.runs;
  of.history = {history.error, history.validation, history.norm};
  of.prior_error_m = t.prior;
  of.validation_prior_error_m = t.validation_prior;
  of.window_m = options.window_m;
  of.heading_window_deg = options.heading_window_deg;
  OptionTexts texts;
  Options copy = options;
  VisitOptions(texts, copy);
  of.options = texts.all;
  if (!t.warnings.empty()) of.warnings = t.warnings;
  if (!data.input_doubts.empty()) of.input_doubts = data.input_doubts;
  of.map.sample_hash = set.sample_hash;
  of.held_out = CheckHeldOut(options, data, parameters);
  if (parent != nullptr) {
    of.ancestry = AncestryOf(*parent);
    const std::span<const std::int64_t> before = of.ancestry.sample_hash.values();
    const SamplesInCommon common = InCommon(data.held_out.sample_hash, {before.begin(), before.end()});
    if (common.known > 0)
      of.held_out.known_share = static_cast<double>(common.known) / static_cast<double>(common.all);
  }
  Blob result = BlobOf(of);
  if (starts != nullptr) result.PutAll("", *starts);
  Step step;
  step.plan.set_result(step.Share(result));
  return step;
}

}  // namespace cairn::landmark_learning
