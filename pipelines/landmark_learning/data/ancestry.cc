#include "pipelines/landmark_learning/data/ancestry.h"

#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "pipelines/landmark_learning/networks/arrays.h"
#include "schema/kinds/sample_hashes.h"

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

Parent ParentIn(const kinds::Networks::Weights& of, const NetworkShape& wanted,
                const std::vector<std::string>& input_names) {
  if (!of.hidden_weight) throw InputError("no networks in it; a result of landmark_learning is needed");
  Parameters<double> p = NetworksIn(of);
  if (p.shape != wanted)
    throw InputError(Text(p.shape) + ", where the options and the samples ask for " + Text(wanted));
  CheckInputNames(of.input_name, input_names);
  return {std::move(p.values), {of.input_mean.vector(), of.input_scale.vector()}};
}

std::string Joined(const std::vector<std::string>& texts) {
  std::string joined;
  for (const std::string& text : texts) joined += (joined.empty() ? "" : " ") + text;
  return joined;
}

}  // namespace

Parent ReadParent(const Blob& networks, const NetworkShape& wanted,
                  const std::vector<std::string>& input_names) {
  try {
    return ParentIn(FieldsIn<kinds::Networks::Weights>("networks/", networks), wanted, input_names);
  } catch (const InputError& error) {
    throw InputError(std::string("the input 'weights': ") + error.what());
  }
}

kinds::Networks::Ancestry AncestryOf(const Blob& file) {
  const auto parent = Read<kinds::Networks>(file);
  const kinds::Networks::Ancestry& before = parent.ancestry;
  const std::span<const double> history = parent.history.training_error_m;
  const auto with = []<class T>(const Column<T>& earlier, T last) {
    std::vector<T> all(earlier.OrNone().begin(), earlier.OrNone().end());
    all.push_back(std::move(last));
    return all;
  };
  const std::set<std::int64_t> known = SamplesKnownTo(parent);
  return {with(before.hash, file.Without("provenance/").ContentHash().Hex()),
          with(before.options, Joined(parent.options.OrNone())),
          with(before.steps, static_cast<std::int64_t>(history.size())),
          std::vector(known.begin(), known.end()),
          with(before.training_error_m, history.empty() ? std::nan("") : history.back()),
          with(before.prior_error_m, parent.prior_error_m.Scalar())};
}

}  // namespace cairn::landmark_learning
