#include "datasets/evaluate/learned_networks.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets {
namespace {

std::string ShapeText(const Shape& shape) {
  std::string text;
  for (const std::int64_t length : shape) text += (text.empty() ? "" : ",") + std::to_string(length);
  return "[" + text + "]";
}

void RequireShape(const Blob& file, const std::string& name, const std::vector<std::size_t>& lengths) {
  Shape wanted;
  for (const std::size_t length : lengths) wanted.push_back(static_cast<std::int64_t>(length));
  const Shape& shape = file.at(name).shape();
  if (shape != wanted)
    throw InputError("'" + name + "' has the shape " + ShapeText(shape) + ", where " + ShapeText(wanted) +
                     " fits the other arrays");
}

template <class T>
std::vector<double> Numbers(const Blob& file, const std::string& name,
                            const std::vector<std::size_t>& lengths) {
  RequireShape(file, name, lengths);
  const std::span<const T> values = file.Get<T>(name);
  const auto bad = std::ranges::find_if(values, [](T value) { return !std::isfinite(value); });
  if (bad != values.end())
    throw InputError("'" + name + "': entry " + std::to_string(bad - values.begin()) + " is no number");
  return {values.begin(), values.end()};
}

void ReadShape(const Blob& file, LearnedNetworks* nets) {
  const Shape& shape = file.at("networks/hidden_weight").shape();
  if (shape.size() != 3 || std::ranges::count(shape, 0) > 0)
    throw InputError("'networks/hidden_weight' has the shape " + ShapeText(shape) +
                     ", where [networks,hidden,inputs], each at least 1, is needed");
  nets->networks = static_cast<std::size_t>(shape[0]);
  nets->hidden = static_cast<std::size_t>(shape[1]);
  nets->inputs = static_cast<std::size_t>(shape[2]);
  if (nets->networks > kMostNetworks)
    throw InputError("'networks/hidden_weight': " + std::to_string(nets->networks) + " networks; allowed: " +
                     std::to_string(kMostNetworks) + " at most, as there are 2^n feature vectors");
  if (!file.Has("networks/hidden_2_weight")) return;
  const Shape& second = file.at("networks/hidden_2_weight").shape();
  if (second.size() != 3 || std::ranges::count(second, 0) > 0)
    throw InputError("'networks/hidden_2_weight' has the shape " + ShapeText(second) +
                     ", where [networks,hidden_2,hidden], each at least 1, is needed");
  nets->hidden_2 = static_cast<std::size_t>(second[1]);
}

void ReadWeights(const Blob& file, LearnedNetworks* nets) {
  const std::size_t n = nets->networks, h = nets->hidden, i = nets->inputs;
  nets->hidden_weight = Numbers<double>(file, "networks/hidden_weight", {n, h, i});
  nets->hidden_bias = Numbers<double>(file, "networks/hidden_bias", {n, h});
  if (nets->hidden_2 > 0) {
    nets->hidden_2_weight = Numbers<double>(file, "networks/hidden_2_weight", {n, nets->hidden_2, h});
    nets->hidden_2_bias = Numbers<double>(file, "networks/hidden_2_bias", {n, nets->hidden_2});
  }
  nets->output_weight =
      Numbers<double>(file, "networks/output_weight", {n, nets->hidden_2 > 0 ? nets->hidden_2 : h});
  nets->output_bias = Numbers<double>(file, "networks/output_bias", {n});
  nets->input_mean = Numbers<double>(file, "networks/input_mean", {i});
  nets->input_scale = Numbers<double>(file, "networks/input_scale", {i});
  RequireShape(file, "networks/input_name", {i});
  nets->input_name = file.Texts("networks/input_name");
  const auto flat = std::ranges::find_if(nets->input_scale, [](double scale) { return scale <= 0; });
  if (flat != nets->input_scale.end())
    throw InputError("'networks/input_scale': entry " + std::to_string(flat - nets->input_scale.begin()) +
                     " is not above 0");
}

void ReadMap(const Blob& file, LearnedNetworks* nets) {
  const auto samples = static_cast<std::size_t>(file.at("map/x_m").size());
  if (samples == 0) throw InputError("'map/x_m' is empty: there are no training samples to evaluate with");
  nets->x_m = Numbers<double>(file, "map/x_m", {samples});
  nets->y_m = Numbers<double>(file, "map/y_m", {samples});
  nets->output = Numbers<float>(file, "map/output", {samples, nets->networks});
  const auto bad = std::ranges::find_if(nets->output, [](double g) { return g < 0 || g > 1; });
  if (bad != nets->output.end())
    throw InputError("'map/output': entry " + std::to_string(bad - nets->output.begin()) +
                     " is no probability");
  if (file.Has("map/heading_rad")) nets->heading_rad = Numbers<double>(file, "map/heading_rad", {samples});
  nets->runs = file.Texts("runs");
  RequireShape(file, "map/run", {samples});
  const auto run = file.Get<std::int32_t>("map/run");
  nets->run.assign(run.begin(), run.end());
  for (std::size_t k = 0; k < samples; ++k) {
    if (run[k] < 0 || static_cast<std::size_t>(run[k]) >= nets->runs.size())
      throw InputError("'map/run': entry " + std::to_string(k) + " is " + std::to_string(run[k]) +
                       ", but there are " + std::to_string(nets->runs.size()) + " runs");
  }
}

double Sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

// A layer's units first <= u < first + count, which all see `in`.
std::vector<double> Layer(std::span<const double> in, std::span<const double> weights,
                          std::span<const double> biases, std::size_t first, std::size_t count) {
  std::vector<double> out;
  for (std::size_t unit = first; unit < first + count; ++unit) {
    double sum = biases[unit];
    for (std::size_t i = 0; i < in.size(); ++i) sum += weights[unit * in.size() + i] * in[i];
    out.push_back(Sigmoid(sum));
  }
  return out;
}

}  // namespace

LearnedNetworks ReadLearnedNetworks(const Blob& file) {
  LearnedNetworks nets;
  ReadShape(file, &nets);
  ReadWeights(file, &nets);
  ReadMap(file, &nets);
  if (file.Has("window_m")) nets.window_m = file.Scalar<double>("window_m");
  if (file.Has("heading_window_deg")) nets.heading_window_deg = file.Scalar<double>("heading_window_deg");
  if (!(nets.heading_window_deg >= 0)) throw InputError("'heading_window_deg' is not 0 or above");
  if (!(nets.window_m >= 0)) throw InputError("'window_m' is not 0 or above");
  return nets;
}

std::vector<double> OutputsOf(const LearnedNetworks& nets, std::span<const float> input) {
  CAIRN_DEMAND(input.size() % nets.inputs == 0, "rows of inputs are not whole");
  std::vector<double> outputs, x(nets.inputs);
  for (std::size_t row = 0; row < input.size(); row += nets.inputs) {
    for (std::size_t i = 0; i < nets.inputs; ++i)
      x[i] = (input[row + i] - nets.input_mean[i]) / nets.input_scale[i];
    for (std::size_t n = 0; n < nets.networks; ++n) {
      std::vector<double> hidden =
          Layer(x, nets.hidden_weight, nets.hidden_bias, n * nets.hidden, nets.hidden);
      if (nets.hidden_2 > 0)
        hidden = Layer(hidden, nets.hidden_2_weight, nets.hidden_2_bias, n * nets.hidden_2, nets.hidden_2);
      outputs.push_back(Layer(hidden, nets.output_weight, nets.output_bias, n, 1).front());
    }
  }
  return outputs;
}

}  // namespace cairn::datasets
