#include "datasets/evaluate/learning/learned_networks.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets {
namespace {

template <class T>
std::vector<double> Numbers(const Blob& file, const std::string& name) {
  const std::span<const T> values = file.Get<T>(name);
  return {values.begin(), values.end()};
}

void ReadShape(const Blob& file, LearnedNetworks* nets) {
  const Shape& shape = file.at("networks/hidden_weight").shape();
  nets->networks = static_cast<std::size_t>(shape[0]);
  nets->hidden = static_cast<std::size_t>(shape[1]);
  nets->inputs = static_cast<std::size_t>(shape[2]);
  if (nets->networks < 1 || nets->networks > kMostNetworks)
    throw InputError("'networks/hidden_weight': " + std::to_string(nets->networks) +
                     " networks; allowed: 1 to " + std::to_string(kMostNetworks) +
                     ", as there are 2^n feature vectors");
  if (file.Has("networks/hidden_2_weight"))
    nets->hidden_2 = static_cast<std::size_t>(file.at("networks/hidden_2_weight").shape()[1]);
  const std::size_t last = nets->hidden_2 > 0 ? nets->hidden_2 : nets->hidden;
  if (nets->hidden == 0 || nets->inputs == 0 ||
      file.at("networks/output_weight").shape()[1] != static_cast<std::int64_t>(last))
    throw InputError("'networks/output_weight' is not of the last hidden layer, or a layer has no units");
}

void ReadWeights(const Blob& file, LearnedNetworks* nets) {
  nets->hidden_weight = Numbers<double>(file, "networks/hidden_weight");
  nets->hidden_bias = Numbers<double>(file, "networks/hidden_bias");
  if (nets->hidden_2 > 0) {
    nets->hidden_2_weight = Numbers<double>(file, "networks/hidden_2_weight");
    nets->hidden_2_bias = Numbers<double>(file, "networks/hidden_2_bias");
  }
  nets->output_weight = Numbers<double>(file, "networks/output_weight");
  nets->output_bias = Numbers<double>(file, "networks/output_bias");
  nets->input_mean = Numbers<double>(file, "networks/input_mean");
  nets->input_scale = Numbers<double>(file, "networks/input_scale");
  nets->input_name = file.Texts("networks/input_name");
}

void ReadMap(const Blob& file, LearnedNetworks* nets) {
  nets->x_m = Numbers<double>(file, "map/x_m");
  if (nets->x_m.empty())
    throw InputError("'map/x_m' is empty: there are no training samples to evaluate with");
  nets->y_m = Numbers<double>(file, "map/y_m");
  nets->output = Numbers<float>(file, "map/output");
  if (file.Has("map/heading_rad")) nets->heading_rad = Numbers<double>(file, "map/heading_rad");
  nets->runs = file.Texts("runs");
  const auto run = file.Get<std::int32_t>("map/run");
  nets->run.assign(run.begin(), run.end());
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
