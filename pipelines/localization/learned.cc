#include "pipelines/localization/learned.h"

#include <algorithm>
#include <cmath>

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

NetworkShape ShapeOf(const Blob& file) {
  const Shape& shape = file.at("networks/hidden_weight").shape();
  if (shape.size() != 3 || std::ranges::any_of(shape, [](std::int64_t n) { return n < 1 || n > 1'000'000; }))
    throw InputError("'networks/hidden_weight' is not [networks, hidden, inputs]");
  return {static_cast<int>(shape[0]), static_cast<int>(shape[2]), static_cast<int>(shape[1])};
}

Parameters<float> ParametersOf(const Blob& file) {
  Parameters<float> p(ShapeOf(file));
  const NetworkShape& s = p.shape;
  const auto hidden_weight =
      Checked<double>(file, "networks/hidden_weight", {s.networks, s.hidden, s.inputs});
  const auto hidden_bias = Checked<double>(file, "networks/hidden_bias", {s.networks, s.hidden});
  const auto output_weight = Checked<double>(file, "networks/output_weight", {s.networks, s.hidden});
  const auto output_bias = Checked<double>(file, "networks/output_bias", {s.networks});
  for (int u = 0; u < s.units(); ++u) {
    const auto unit = static_cast<std::size_t>(u);
    for (int i = 0; i < s.inputs; ++i) {
      const std::size_t at = unit * static_cast<std::size_t>(s.inputs) + static_cast<std::size_t>(i);
      p.HiddenWeights(i)[u] = static_cast<float>(hidden_weight[at]);
    }
    p.HiddenBiases()[u] = static_cast<float>(hidden_bias[unit]);
    p.OutputWeights()[u] = static_cast<float>(output_weight[unit]);
  }
  std::ranges::transform(output_bias, p.OutputBiases(), [](double b) { return static_cast<float>(b); });
  return p;
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
  for (std::size_t k = 0; k < x.size(); ++k) places_.push_back({x[k], y[k]});
  outputs_.assign(outputs.begin(), outputs.end());
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
