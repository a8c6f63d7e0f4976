// Networks and samples made by hand, for this folder's tests.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

// n networks of one hidden unit each, every one a function of the one input 'input0' at most: output i =
// s(bias[i] + weight[i] s(slope[i] x + offset[i])).
struct NetworkByHand {
  double slope = 0, offset = 0, weight = 0, bias = 0;
};

// `output`: [samples][networks].
inline Blob NetworksFile(const std::vector<NetworkByHand>& networks, const std::vector<double>& x_m,
                         const std::vector<float>& output) {
  const auto n = static_cast<std::int64_t>(networks.size()), samples = static_cast<std::int64_t>(x_m.size());
  std::vector<double> slope, offset, weight, bias;
  for (const NetworkByHand& net : networks) {
    slope.push_back(net.slope);
    offset.push_back(net.offset);
    weight.push_back(net.weight);
    bias.push_back(net.bias);
  }
  Blob file;
  file.Put("networks/hidden_weight", Array::Of<double>({n, 1, 1}, slope));
  file.Put("networks/hidden_bias", Array::Of<double>({n, 1}, offset));
  file.Put("networks/output_weight", Array::Of<double>({n, 1}, weight));
  file.PutVector("networks/output_bias", bias);
  file.PutVector("networks/input_mean", std::vector<double>{0});
  file.PutVector("networks/input_scale", std::vector<double>{1});
  file.Put("networks/input_name", Array::Texts({"input0"}));
  file.PutVector("map/x_m", x_m);
  file.PutVector("map/y_m", std::vector<double>(x_m.size(), 0.0));
  file.PutVector("map/along_m", x_m);
  file.PutVector("map/run", std::vector<std::int32_t>(x_m.size(), 0));
  file.Put("map/output", Array::Of<float>({samples, n}, output));
  file.Put("runs", Array::Texts({"trained"}));
  file.PutScalar("window_m", 2.0);
  return file;
}

struct RunByHand {
  std::string name;
  std::vector<double> x_m;
  std::vector<float> input;
};

inline Blob SamplesFile(const std::vector<RunByHand>& runs) {
  Blob file;
  std::vector<std::string> names;
  for (const RunByHand& run : runs) {
    const std::string prefix = "run/" + std::to_string(names.size()) + "/";
    const auto rows = static_cast<std::int64_t>(run.x_m.size());
    names.push_back(run.name);
    file.PutVector(prefix + "time_s", run.x_m);
    file.PutVector(prefix + "x_m", run.x_m);
    file.PutVector(prefix + "y_m", std::vector<double>(run.x_m.size(), 0.0));
    file.Put(prefix + "input", Array::Of<float>({rows, 1}, run.input));
  }
  file.Put("runs", Array::Texts(names));
  file.Put("input_name", Array::Texts({"input0"}));
  return file;
}

}  // namespace cairn::datasets
