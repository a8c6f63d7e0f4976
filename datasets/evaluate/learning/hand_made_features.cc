#include "datasets/evaluate/learning/hand_made_features.h"

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/learning/learned_networks.h"

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

FeatureRun ReadRun(const Blob& file, std::size_t number, const std::string& name,
                   const std::vector<std::string>& names, const std::vector<std::size_t>& columns) {
  const std::string prefix = "run/" + std::to_string(number) + "/";
  const auto x = file.Get<double>(prefix + "x_m"), y = file.Get<double>(prefix + "y_m");
  const auto feature = file.Get<float>(prefix + "feature");
  FeatureRun run{name, number, {x.begin(), x.end()}, {y.begin(), y.end()}, {}, {}};
  if (file.Has(prefix + "heading_rad")) {
    const auto heading = file.Get<double>(prefix + "heading_rad");
    run.heading_rad.assign(heading.begin(), heading.end());
  }
  for (std::size_t k = 0; k < x.size(); ++k)
    for (const std::size_t column : columns) run.output.push_back(feature[k * names.size() + column]);
  return run;
}

}  // namespace

std::vector<FeatureRun> ReadFeatureRuns(const Blob& file, const std::vector<std::string>& features) {
  if (!file.Has("feature_name")) throw InputError("there are no hand-made features");
  const std::vector<std::string> names = file.Texts("feature_name"), runs = file.Texts("runs");
  const std::vector<std::size_t> columns = ColumnsOf(features, names);
  std::vector<FeatureRun> read;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    FeatureRun run = ReadRun(file, r, runs[r], names, columns);
    if (!run.x_m.empty()) read.push_back(std::move(run));
  }
  if (read.empty()) throw InputError("there are no samples");
  return read;
}

}  // namespace cairn::datasets
