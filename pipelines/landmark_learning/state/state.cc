#include "pipelines/landmark_learning/state/state.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pipelines/common/handed_over.h"

namespace cairn::landmark_learning {
namespace {

std::vector<double> WeightsIn(const Blob& blob) {
  const auto weights = blob.Get<double>("weights");
  return {weights.begin(), weights.end()};
}

Blob WeightsBlob(const std::vector<double>& weights) {
  Blob blob;
  blob.PutVector("weights", weights);
  return blob;
}

}  // namespace

void Training::Share(const State& before, const Inputs& inputs, Step* step) {
  auto& names = *step->plan.mutable_state()->mutable_blobs();
  history.Share(before, inputs, step);
  names["parameters"] = step->Share(WeightsBlob(weights));
  if (best_is_new_)
    names["best"] = step->Share(WeightsBlob(best));
  else if (!best.empty())
    names["best"] = before.blobs().at("best");
  names["training"] = step->Share(BlobOf(*this));
}

Training Training::Of(const Options& options, const NetworkShape& shape, const Inputs& inputs) {
  auto t = Read<Training>(*inputs.Get("training"));
  t.weights = WeightsIn(*inputs.Get("parameters"));
  if (inputs.Has("best")) t.best = WeightsIn(*inputs.Get("best"));
  t.Check(options, shape);
  return t;
}

void Training::Check(const Options& options, const NetworkShape& shape) const {
  RequireWithin("the phase", static_cast<std::int64_t>(phase), 0, static_cast<std::int64_t>(Phase::kWeights));
  for (const std::int64_t count : {steps, network_steps, descent.step, conjugate.since_restart})
    RequireWithin("a number of steps", count, 0, options.steps);
  RequireWithin("the networks in use", std::int64_t{learning.end}, 1, shape.networks);
  RequireWithin("the first that learns", std::int64_t{learning.first}, 0, learning.end - 1);
  RequireSize("weights", weights.size(), shape.parameters());
  if (!best.empty()) RequireSize("the best weights", best.size(), shape.parameters());
  NetworkShape learn = shape;
  learn.networks = learning.end - learning.first;
  for (const auto* memory : {&descent.first, &descent.second, &conjugate.gradient, &conjugate.direction})
    if (!memory->empty()) RequireSize("the optimiser's memory", memory->size(), learn.parameters());
  RequireSize("the direction of the last step", conjugate.direction.size(), conjugate.gradient.size());
}

void Training::Record(double error, double validation, double gradient_norm) {
  history.Add(error, validation, gradient_norm);
  rising = error > last_error ? rising + 1 : 0;
  last_error = error;
  if (std::isnan(validation)) return;
  ++since_best;
  if (validation >= best_validation) return;
  best_validation = validation;
  best = weights;
  best_is_new_ = true;
  since_best = 0;
}

std::string Training::Warn(const std::vector<std::int32_t>& now_saturated) {
  std::string text;
  for (const std::int32_t network : now_saturated) {
    if (std::ranges::find(saturated, network) == saturated.end())
      text += (text.empty() ? "network " : "; network ") + std::to_string(network) +
              " is saturated: its gradient is exactly zero";
  }
  saturated = now_saturated;
  if (rising == kRisingSteps)
    text += std::string(text.empty() ? "" : "; ") + "the error has risen for ten steps running";
  if (!text.empty() && warnings.size() < kMostWarnings)
    warnings.push_back("step " + std::to_string(steps + 1) + ": " + text);
  return text;
}

void Training::NextNetwork() {
  if (!best.empty()) weights = best;
  best.clear();
  best_is_new_ = false;
  best_validation = std::numeric_limits<double>::infinity();
  since_best = network_steps = rising = 0;
  last_error = kNone;
  descent = {};
  // [Thr98] section 4.4.2, item 1: networks are trained one after another.
  learning = {learning.end, learning.end + 1};
}

NetworkShape ShapeOf(const Options& options, std::size_t inputs) {
  return {static_cast<int>(options.networks), static_cast<int>(inputs), static_cast<int>(options.hidden),
          static_cast<int>(options.hidden_2)};
}

DescentRules RulesOf(const Options& options) {
  const Method method = options.method == "gradient" ? Method::kGradient
                        : options.method == "adam"   ? Method::kAdam
                                                     : Method::kMomentum;
  return {method, RateOf(options), options.momentum, options.weight_decay};
}

Learning FirstLearning(const Options& options) {
  return {0, options.sequential ? 1 : static_cast<int>(options.networks)};
}

Parameters<float> InFloat(const NetworkShape& shape, const Blob& weights) {
  return InFloat(shape, weights.Get<double>("weights"));
}

Parameters<float> InFloat(const NetworkShape& shape, std::span<const double> weights) {
  Parameters<float> parameters(shape);
  if (weights.size() != parameters.values.size()) {
    throw InputError("there are " + std::to_string(weights.size()) + " weights where the networks have " +
                     std::to_string(parameters.values.size()));
  }
  std::ranges::transform(weights, parameters.values.begin(), [](double w) { return static_cast<float>(w); });
  return parameters;
}

}  // namespace cairn::landmark_learning
