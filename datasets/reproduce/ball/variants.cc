#include "datasets/reproduce/ball/variants.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "datasets/evaluate/learning/networks.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/over_seeds.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

bool IsSonar(const std::string& input) { return input.starts_with("sonar"); }
bool IsTexture(const std::string& input) { return input.ends_with("texture"); }
bool IsBrightness(const std::string& input) { return input.ends_with("brightness"); }
bool IsColour(const std::string& input) {
  return !IsSonar(input) && !IsTexture(input) && !IsBrightness(input);
}

template <class Group>
BallVariant LeftOut(const std::string& stage, const std::string& what, const Group& group) {
  return {stage, "without " + what, [group](const std::string& input) { return !group(input); }, {}};
}

proto::Value TextValue(const std::string& text) {
  proto::Value value;
  value.set_s(text);
  return value;
}

proto::Value YesValue() {
  proto::Value value;
  value.set_b(true);
  return value;
}

std::string TrainingOf(const BallVariant& variant) {
  return variant.keeps ? "training_" + variant.stage : "training";
}

double SecondsOf(const Blob& result) {
  if (!result.Has("provenance/round/compute_s")) return NAN;
  const auto seconds = result.Get<double>("provenance/round/compute_s");
  return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

}  // namespace

std::vector<BallVariant> SensorVariants() {
  return {{"all", "all sensors", {}, {}},
          LeftOut("no_rows", "the image's rows", [](const std::string& i) { return i.starts_with("row"); }),
          LeftOut("no_columns", "its columns", [](const std::string& i) { return i.starts_with("column"); }),
          LeftOut("no_brightness", "brightness", IsBrightness),
          LeftOut("no_colour", "colour", IsColour),
          LeftOut("no_texture", "texture", IsTexture),
          LeftOut("no_sonar", "sonars", IsSonar),
          LeftOut("no_camera", "the camera (sonars alone)",
                  [](const std::string& input) { return !IsSonar(input); })};
}

std::vector<BallVariant> TrainingVariants(std::int64_t steps) {
  // Rates are the methods' own; weights that begin near zero hold those up that follow the gradient as it is;
  // weight decay comes to what Adam's does, a step.
  const auto method = [&](const char* method, const char* title, std::int64_t its_steps,
                          double weight_decay) {
    return BallVariant{method,
                       title,
                       {},
                       {{"method", TextValue(method)},
                        {"rate", RealValue(0)},
                        {"init_width", RealValue(0.5)},
                        {"weight_decay", RealValue(weight_decay)},
                        {"steps", IntegerValue(its_steps)}}};
  };
  std::vector<BallVariant> variants = {{"adam", "Adam", {}, {}}};
  variants.push_back(method("gradient", "plain descent (table 2), 10 times the steps", 10 * steps, 2.5e-5));
  variants.push_back(method("momentum", "momentum, 4 times the steps", 4 * steps, 5e-5));
  variants.push_back(method("conjugate", "conjugate gradients", steps, 0));
  variants.push_back(method("pseudo", "pseudo-patterns (eq. 45), a tenth of the gradients",
                            std::max<std::int64_t>(1, steps / 10), 0));
  variants.push_back({"sequential", "Adam, one network after another", {}, {{"sequential", YesValue()}}});
  for (const std::int64_t hidden : {2, 4, 12, 24}) {
    variants.push_back({"hidden_" + std::to_string(hidden),
                        "Adam, " + std::to_string(hidden) + " hidden units (else 6)",
                        {},
                        {{"hidden", IntegerValue(hidden)}}});
  }
  for (const std::int64_t each : {4, 6, 12}) {
    const std::string units = std::to_string(each);
    variants.push_back({"layers_" + units,
                        "Adam, two hidden layers of " + units + " units",
                        {},
                        {{"hidden", IntegerValue(each)}, {"hidden_2", IntegerValue(each)}}});
  }
  return variants;
}

Blob WithInputs(const Blob& samples, const std::function<bool(const std::string& input)>& keeps) {
  const std::vector<std::string> all = samples.Texts("input_name");
  std::vector<std::string> kept;
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!keeps(all[i])) continue;
    kept.push_back(all[i]);
    columns.push_back(i);
  }
  Blob rest = samples;
  rest.Put("input_name", Array::Texts(kept));
  for (std::size_t r = 0; r < samples.Texts("runs").size(); ++r) {
    const std::string name = "run/" + std::to_string(r) + "/input";
    const auto input = samples.Get<float>(name);
    std::vector<float> values;
    for (std::size_t row = 0; row < input.size(); row += all.size()) {
      for (const std::size_t column : columns) values.push_back(input[row + column]);
    }
    const auto rows = static_cast<std::int64_t>(input.size() / all.size());
    rest.Put(name, Array::Of<float>({rows, static_cast<std::int64_t>(kept.size())}, values));
  }
  return rest;
}

BallJob MakeVariantJob(const std::string& study, const std::string& set, std::uint64_t seed,
                       const BallRecipe& recipe, const std::vector<BallVariant>& variants) {
  BallJob ball = BareBallJob(study, set, seed);
  for (const BallVariant& variant : variants) {
    if (variant.keeps)
      AddInput(TrainingOf(variant), WithInputs(ball.inputs.at("training"), variant.keeps), &ball);
    BallRecipe options = {{"networks", IntegerValue(kMostBallNetworks)},
                          {"window_m", RealValue(kBallWindowM)}};
    for (const auto& [name, value] : variant.options) options[name] = value;
    AddTraining(variant.stage, TrainingOf(variant), recipe, options, &ball.job);
  }
  ball.job.mutable_inputs()->erase("samples");  // scored on, not computed with
  return ball;
}

VariantScores ScoreVariantJob(const BallJob& ball, const std::vector<BallVariant>& variants,
                              const std::map<std::string, Blob>& results) {
  ScoreOptions how;
  how.samplings = 1;
  how.windows_m = {kBallWindowM};
  VariantScores scores;
  scores.set = ball.set;
  for (const BallVariant& variant : variants) {
    const auto found = results.find(variant.stage);
    if (found == results.end()) throw InputError("the study's stage '" + variant.stage + "' has no result");
    const Blob samples = variant.keeps ? WithInputs(ball.samples(), variant.keeps) : ball.samples();
    const auto windows = EvaluateNetworks(found->second, samples, how).windows;
    scores.reduction[variant.stage] = windows.front().soft.error_reduction.value_or(NAN);
    scores.seconds[variant.stage] = SecondsOf(found->second);
  }
  return scores;
}

PaperFigure VariantFigure(PaperFigure figure, const std::vector<BallVariant>& variants,
                          const std::vector<VariantScores>& scores, bool times) {
  std::vector<std::string> sets;
  for (const VariantScores& score : scores) {
    if (std::ranges::find(sets, score.set) == sets.end()) sets.push_back(score.set);
  }
  figure.table.head = {"error reduction, percent"};
  for (const std::string& set : sets) {
    figure.table.head.push_back("D-" + set.substr(1));
    figure.table.head.emplace_back("less");
  }
  if (times) figure.table.head.emplace_back("computing s");
  for (const BallVariant& variant : variants) {
    std::vector<std::string> row = {variant.title};
    std::vector<double> seconds;
    for (const std::string& set : sets) {
      std::vector<double> values, less;
      for (const VariantScores& score : scores) {
        if (score.set != set) continue;
        values.push_back(score.reduction.at(variant.stage));
        less.push_back(score.reduction.at(variants.front().stage) - values.back());
        seconds.push_back(score.seconds.at(variant.stage));
      }
      row.push_back(PercentText(MeanOverSeeds(values)));
      row.push_back(&variant == &variants.front() ? "" : PercentText(MeanOverSeeds(less)));
    }
    if (times) row.push_back(Say("%.1f", MeanOverSeeds(seconds).mean));
    figure.table.rows.push_back(std::move(row));
  }
  return figure;
}

}  // namespace cairn::datasets
