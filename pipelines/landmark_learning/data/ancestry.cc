#include "pipelines/landmark_learning/data/ancestry.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "pipelines/landmark_learning/networks/arrays.h"

namespace cairn::landmark_learning {
namespace {

std::string Text(const NetworkShape& s) {
  return std::to_string(s.networks) + " networks of " + std::to_string(s.hidden) +
         (s.hidden_2 > 0 ? " and " + std::to_string(s.hidden_2) : "") + " hidden units over " +
         std::to_string(s.inputs) + " inputs";
}

void CheckInputNames(const std::vector<std::string>& names, const std::vector<std::string>& input_names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i >= input_names.size() || names[i] != input_names[i])
      throw InputError("its input " + std::to_string(i) + " is '" + names[i] + "', not the samples' '" +
                       (i < input_names.size() ? input_names[i] : "") + "'");
  }
}

std::vector<double> NormIn(const Blob& networks, const std::string& name, int inputs) {
  const auto values = networks.Get<double>(name);
  if (values.size() != static_cast<std::size_t>(inputs)) {
    throw InputError("'" + name + "' has " + std::to_string(values.size()) + " numbers, not " +
                     std::to_string(inputs));
  }
  const auto bad = std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
  if (bad != values.end()) {
    throw InputError("'" + name + "', entry " + std::to_string(bad - values.begin()) +
                     " is not a finite number");
  }
  return {values.begin(), values.end()};
}

Parent Read(const Blob& networks, const NetworkShape& wanted, const std::vector<std::string>& input_names) {
  if (!networks.Has("networks/hidden_weight"))
    throw InputError("no networks in it; a result of landmark_learning is needed");
  Parameters<double> p = NetworksIn(networks);
  if (p.shape != wanted)
    throw InputError(Text(p.shape) + ", where the options and the samples ask for " + Text(wanted));
  CheckInputNames(networks.Texts("networks/input_name"), input_names);
  Parent parent{std::move(p.values),
                {NormIn(networks, "networks/input_mean", wanted.inputs),
                 NormIn(networks, "networks/input_scale", wanted.inputs)}};
  for (std::size_t i = 0; i < parent.norm.scale.size(); ++i) {
    if (parent.norm.scale[i] <= 0.0)
      throw InputError("'networks/input_scale', entry " + std::to_string(i) + " is not above 0");
  }
  return parent;
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
  try {
    return Read(networks, wanted, input_names);
  } catch (const InputError& error) {
    throw InputError(std::string("the input 'weights': ") + error.what());
  }
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
