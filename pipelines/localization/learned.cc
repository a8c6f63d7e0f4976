#include "pipelines/localization/learned.h"

#include <algorithm>

#include "pipelines/landmark_learning/networks/arrays.h"
#include "pipelines/landmark_learning/state/state.h"
#include "schema/kinds/networks_worth.h"
#include "schema/kinds/sample_hashes.h"

namespace cairn::localization {
namespace {

using landmark_learning::Parameters;

Parameters<float> ParametersOf(const Blob& file) {
  const Parameters<double> read =
      landmark_learning::NetworksIn(FieldsIn<kinds::Networks::Weights>("networks/", file));
  return landmark_learning::InFloat(read.shape, read.values);
}

std::vector<std::string> RunsInMap(const kinds::Networks& of) {
  std::vector<std::string> in_map;
  for (std::size_t r = 0; r < of.runs.size(); ++r) {
    if (std::ranges::count(of.map.run, static_cast<std::int32_t>(r)) > 0) in_map.push_back(of.runs[r]);
  }
  return in_map;
}

}  // namespace

Learned::Learned(const Blob& file) : parameters_(ParametersOf(file)) {
  const auto of = Read<kinds::Networks>(file);
  mean_ = of.networks.input_mean.vector();
  scale_ = of.networks.input_scale.vector();
  input_names_ = of.networks.input_name.values();
  trained_on_ = RunsInMap(of);
  worth_ = WorthOf(of);
  known_samples_ = SamplesKnownTo(of);
  for (std::size_t k = 0; k < of.map.x_m.size(); ++k) positions_.push_back({of.map.x_m[k], of.map.y_m[k]});
  outputs_.assign(of.map.output.begin(), of.map.output.end());
  if (of.map.heading_rad) headings_rad_ = of.map.heading_rad.vector();
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
