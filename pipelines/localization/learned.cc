#include "pipelines/localization/learned.h"

#include <algorithm>
#include <cmath>

#include "pipelines/landmark_learning/networks/arrays.h"
#include "pipelines/landmark_learning/training.h"

namespace cairn::localization {
namespace {

using landmark_learning::NetworkShape;
using landmark_learning::Parameters;

template <class T>
std::span<const T> Checked(const Blob& file, const std::string& name, const Shape& shape) {
  const auto values = file.Get<T>(name);
  if (file.at(name).shape() != shape)
    throw InputError("'" + name + "' does not have the other arrays' shape");
  const auto bad = std::ranges::find_if(values, [](T value) { return !std::isfinite(value); });
  if (bad != values.end())
    throw InputError("'" + name + "': entry " + std::to_string(bad - values.begin()) + " is no number");
  return values;
}

Parameters<float> ParametersOf(const Blob& file) {
  const Parameters<double> read = landmark_learning::NetworksIn(file);
  return landmark_learning::InFloat(read.shape, read.values);
}

std::vector<std::string> RunsInMap(const Blob& file) {
  const std::vector<std::string> runs = file.Texts("runs");
  std::vector<bool> seen(runs.size(), false);
  for (const std::int32_t run : file.Get<std::int32_t>("map/run")) {
    if (run < 0 || static_cast<std::size_t>(run) >= runs.size())
      throw InputError("'map/run' names a run that is not there");
    seen[static_cast<std::size_t>(run)] = true;
  }
  std::vector<std::string> in_map;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (seen[r]) in_map.push_back(runs[r]);
  }
  return in_map;
}

}  // namespace

Learned::Learned(const Blob& file)
    : parameters_(ParametersOf(file)),
      input_names_(file.Texts("networks/input_name")),
      trained_on_(RunsInMap(file)) {
  const NetworkShape& s = parameters_.shape;
  const auto mean = Checked<double>(file, "networks/input_mean", {s.inputs});
  const auto scale = Checked<double>(file, "networks/input_scale", {s.inputs});
  mean_.assign(mean.begin(), mean.end());
  scale_.assign(scale.begin(), scale.end());
  if (std::ranges::any_of(scale_, [](double x) { return x <= 0.0; }))
    throw InputError("'networks/input_scale' is not above 0 everywhere");
  if (input_names_.size() != mean_.size())
    throw InputError("'networks/input_name' does not have the other arrays' shape");
  const auto x = file.Get<double>("map/x_m");
  const auto samples = static_cast<std::int64_t>(x.size());
  const auto y = Checked<double>(file, "map/y_m", {samples});
  const auto outputs = Checked<float>(file, "map/output", {samples, s.networks});
  for (std::size_t k = 0; k < x.size(); ++k) positions_.push_back({x[k], y[k]});
  outputs_.assign(outputs.begin(), outputs.end());
  if (!file.Has("map/heading_rad")) return;
  const auto headings = Checked<double>(file, "map/heading_rad", {samples});
  headings_rad_.assign(headings.begin(), headings.end());
}

std::vector<std::size_t> Learned::ColumnsIn(const std::vector<std::string>& sample_inputs) const {
  std::vector<std::size_t> columns;
  for (const std::string& name : input_names_) {
    const auto at = std::ranges::find(sample_inputs, name);
    if (at == sample_inputs.end())
      throw InputError("the networks' input '" + name + "' is not among the samples'");
    columns.push_back(static_cast<std::size_t>(at - sample_inputs.begin()));
  }
  return columns;
}

std::vector<float> Learned::OutputsOf(std::span<const float> rows, std::size_t width,
                                      const std::vector<std::size_t>& columns) const {
  std::vector<float> normal;
  for (std::size_t row = 0; row < rows.size(); row += width) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      normal.push_back(static_cast<float>((rows[row + columns[i]] - mean_[i]) / scale_[i]));
  }
  return landmark_learning::Forward(parameters_, normal.data(), static_cast<int>(rows.size() / width)).output;
}

}  // namespace cairn::localization
