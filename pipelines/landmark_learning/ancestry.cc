#include "pipelines/landmark_learning/ancestry.h"

#include <cmath>
#include <cstdint>

namespace cairn::landmark_learning {
namespace {

std::vector<double> Numbers(const Blob& blob, const std::string& name, std::size_t count) {
  const auto values = blob.Get<double>(name);
  if (values.size() != count) {
    throw InputError("the input 'weights': '" + name + "' has " + std::to_string(values.size()) +
                     " numbers, not " + std::to_string(count));
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(values[i]))
      throw InputError("the input 'weights': '" + name + "', entry " + std::to_string(i) +
                       " is not a finite number");
  }
  return {values.begin(), values.end()};
}

std::string Text(std::int64_t networks, std::int64_t hidden, std::int64_t inputs) {
  return std::to_string(networks) + " networks of " + std::to_string(hidden) + " hidden units over " +
         std::to_string(inputs) + " inputs";
}

void RefuseOtherShape(const Blob& networks, const NetworkShape& wanted,
                      const std::vector<std::string>& input_names) {
  if (!networks.Has("networks/hidden_weight"))
    throw InputError("the input 'weights': no networks in it; a result of landmark_learning is needed");
  const Shape& shape = networks.at("networks/hidden_weight").shape();
  if (shape.size() != 3) throw InputError("the input 'weights': 'networks/hidden_weight' has not three axes");
  if (shape[0] != wanted.networks || shape[1] != wanted.hidden || shape[2] != wanted.inputs) {
    throw InputError("the input 'weights': " + Text(shape[0], shape[1], shape[2]) +
                     ", where the options and the samples ask for " +
                     Text(wanted.networks, wanted.hidden, wanted.inputs));
  }
  const auto names = networks.Texts("networks/input_name");
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i >= input_names.size() || names[i] != input_names[i])
      throw InputError("the input 'weights': its input " + std::to_string(i) + " is '" + names[i] +
                       "', not the samples' '" + (i < input_names.size() ? input_names[i] : "") + "'");
  }
}

std::string Joined(const std::vector<std::string>& texts) {
  std::string joined;
  for (const std::string& text : texts) joined += (joined.empty() ? "" : " ") + text;
  return joined;
}

std::vector<double> Doubles(const Blob& blob, const char* name) {
  const auto values = blob.Get<double>(name);
  return {values.begin(), values.end()};
}

}  // namespace

Parent ReadParent(const Blob& networks, const NetworkShape& wanted,
                  const std::vector<std::string>& input_names) {
  RefuseOtherShape(networks, wanted, input_names);
  const auto units = static_cast<std::size_t>(wanted.units()),
             inputs = static_cast<std::size_t>(wanted.inputs);
  const auto hidden = Numbers(networks, "networks/hidden_weight", units * inputs);
  const auto hidden_bias = Numbers(networks, "networks/hidden_bias", units);
  const auto output = Numbers(networks, "networks/output_weight", units);
  const auto output_bias =
      Numbers(networks, "networks/output_bias", static_cast<std::size_t>(wanted.networks));
  Parameters<double> p(wanted);
  for (std::size_t u = 0; u < units; ++u) {
    for (int i = 0; i < wanted.inputs; ++i)
      p.HiddenWeights(i)[u] = hidden[u * inputs + static_cast<std::size_t>(i)];
    p.HiddenBiases()[u] = hidden_bias[u];
    p.OutputWeights()[u] = output[u];
  }
  for (std::size_t n = 0; n < output_bias.size(); ++n) p.OutputBiases()[n] = output_bias[n];
  Parent parent{
      std::move(p.values),
      {Numbers(networks, "networks/input_mean", inputs), Numbers(networks, "networks/input_scale", inputs)}};
  for (std::size_t i = 0; i < inputs; ++i) {
    if (parent.norm.scale[i] <= 0.0)
      throw InputError("the input 'weights': 'networks/input_scale', entry " + std::to_string(i) +
                       " is not above 0");
  }
  return parent;
}

void PutAncestry(const Blob& parent, Blob* result) {
  std::vector<std::string> hashes, options;
  std::vector<double> errors, priors;
  std::vector<std::int64_t> steps;
  if (parent.Has("ancestry/hash")) {
    hashes = parent.Texts("ancestry/hash");
    options = parent.Texts("ancestry/options");
    errors = Doubles(parent, "ancestry/training_error_m");
    priors = Doubles(parent, "ancestry/prior_error_m");
    const auto stored = parent.Get<std::int64_t>("ancestry/steps");
    steps.assign(stored.begin(), stored.end());
  }
  const auto history = parent.Get<double>("history/training_error_m");
  hashes.push_back(parent.Without("provenance/").ContentHash().Hex());
  options.push_back(parent.Has("options") ? Joined(parent.Texts("options")) : "");
  errors.push_back(history.empty() ? std::nan("") : history.back());
  priors.push_back(parent.Scalar<double>("prior_error_m"));
  steps.push_back(static_cast<std::int64_t>(history.size()));
  result->Put("ancestry/hash", Array::Texts(hashes));
  result->Put("ancestry/options", Array::Texts(options));
  result->PutVector("ancestry/training_error_m", errors);
  result->PutVector("ancestry/prior_error_m", priors);
  result->PutVector("ancestry/steps", steps);
}

}  // namespace cairn::landmark_learning
