#include "datasets/evaluate/learning/learned_networks.h"

#include <algorithm>
#include <cmath>

#include "schema/kinds/learning.h"
#include "schema/kinds/sample_hashes.h"

namespace cairn::datasets {
namespace {

void TakeShape(const kinds::Networks::Weights& of, LearnedNetworks* nets) {
  const Shape& shape = of.hidden_weight.shape();
  nets->networks = static_cast<std::size_t>(shape[0]);
  nets->hidden = static_cast<std::size_t>(shape[1]);
  nets->inputs = static_cast<std::size_t>(shape[2]);
  if (nets->networks < 1 || nets->networks > kMostNetworks)
    throw InputError("'" + of.hidden_weight.name() + "': " + std::to_string(nets->networks) +
                     " networks; allowed: 1 to " + std::to_string(kMostNetworks) +
                     ", as there are 2^n feature vectors");
  if (of.hidden_2_weight) nets->hidden_2 = static_cast<std::size_t>(of.hidden_2_weight.shape()[1]);
  const std::size_t last = nets->hidden_2 > 0 ? nets->hidden_2 : nets->hidden;
  if (nets->hidden == 0 || nets->inputs == 0 ||
      of.output_weight.shape()[1] != static_cast<std::int64_t>(last))
    throw InputError("'" + of.output_weight.name() +
                     "' is not of the last hidden layer, or a layer has no units");
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
  const auto of = Read<kinds::Networks>(file);
  const kinds::Networks::Weights& w = of.networks;
  LearnedNetworks nets;
  TakeShape(w, &nets);
  nets.hidden_weight = w.hidden_weight.vector();
  nets.hidden_bias = w.hidden_bias.vector();
  if (nets.hidden_2 > 0) {
    nets.hidden_2_weight = w.hidden_2_weight.vector();
    nets.hidden_2_bias = w.hidden_2_bias.vector();
  }
  nets.output_weight = w.output_weight.vector();
  nets.output_bias = w.output_bias.vector();
  nets.input_mean = w.input_mean.vector();
  nets.input_scale = w.input_scale.vector();
  nets.input_name = w.input_name.values();
  nets.x_m = of.map.x_m.vector();
  if (nets.x_m.empty())
    throw InputError("'map/x_m' is empty: there are no training samples to evaluate with");
  nets.y_m = of.map.y_m.vector();
  nets.output.assign(of.map.output.begin(), of.map.output.end());
  if (of.map.heading_rad) nets.heading_rad = of.map.heading_rad.vector();
  nets.runs = of.runs.values();
  nets.run = of.map.run.vector();
  nets.known = SamplesKnownTo(of);
  nets.window_m = of.window_m.Or(nets.window_m);
  nets.heading_window_deg = of.heading_window_deg.Or(nets.heading_window_deg);
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
