#include "datasets/evaluate/learning/hand_made_features.h"

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/learning/learned_networks.h"
#include "schema/kinds/learning.h"

namespace cairn::datasets {
namespace {

std::string Listed(const std::vector<std::string>& names) {
  std::string listed;
  for (const std::string& name : names) listed += (listed.empty() ? "'" : ", '") + name + "'";
  return listed;
}

std::vector<std::size_t> ColumnsOf(const std::vector<std::string>& features,
                                   const std::vector<std::string>& names) {
  if (features.empty() || features.size() > kMostNetworks)
    throw InputError(std::to_string(features.size()) + " features; allowed: from 1 to " +
                     std::to_string(kMostNetworks));
  std::vector<std::size_t> columns;
  for (const std::string& feature : features) {
    const auto at = std::ranges::find(names, feature);
    if (at == names.end()) throw InputError("no feature '" + feature + "'; there are " + Listed(names));
    const auto column = static_cast<std::size_t>(at - names.begin());
    if (std::ranges::count(columns, column) > 0) throw InputError("feature '" + feature + "' is named twice");
    columns.push_back(column);
  }
  return columns;
}

FeatureRun RunOf(const kinds::Samples::Run& of, std::size_t number, const std::string& name,
                 std::size_t features, const std::vector<std::size_t>& columns) {
  FeatureRun run{name, number, of.x_m.vector(), of.y_m.vector(), {}, {}};
  if (of.heading_rad) run.heading_rad = of.heading_rad.vector();
  const std::span<const float> feature = of.feature;
  for (std::size_t k = 0; k < run.x_m.size(); ++k)
    for (const std::size_t column : columns) run.output.push_back(feature[k * features + column]);
  return run;
}

}  // namespace

std::vector<FeatureRun> ReadFeatureRuns(const Blob& file, const std::vector<std::string>& features) {
  const auto samples = Read<kinds::Samples>(file);
  if (!samples.feature_name) throw InputError("there are no hand-made features");
  const std::vector<std::string>&names = samples.feature_name.values(), &runs = samples.runs.values();
  const std::vector<std::size_t> columns = ColumnsOf(features, names);
  std::vector<FeatureRun> read;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    FeatureRun run = RunOf(samples.run[r], r, runs[r], names.size(), columns);
    if (!run.x_m.empty()) read.push_back(std::move(run));
  }
  if (read.empty()) throw InputError("there are no samples");
  return read;
}

}  // namespace cairn::datasets
