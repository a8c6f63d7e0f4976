#include "pipelines/landmark_learning/networks/arrays.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace cairn::landmark_learning {
namespace {

using Weights = kinds::Networks::Weights;

bool IsSize(std::int64_t length) { return length >= 1 && length <= 1'000'000; }

NetworkShape ShapeIn(const Weights& file) {
  for (const Column<double>& weight : {file.hidden_weight, file.hidden_2_weight})
    if (weight && !std::ranges::all_of(weight.shape(), IsSize))
      throw InputError("'" + weight.name() + "' is of no network, or of too large a one");
  const Shape& first = file.hidden_weight.shape();
  NetworkShape shape{static_cast<int>(first[0]), static_cast<int>(first[2]), static_cast<int>(first[1])};
  if (file.hidden_2_weight) shape.hidden_2 = static_cast<int>(file.hidden_2_weight.shape()[1]);
  return shape;
}

// An array of the file. Of each of `matrices` it has [rows][columns] where the parameters have
// [columns][rows].
struct Layer {
  Column<double> Weights::* array;
  Shape shape;
  int matrices, rows, columns;

  // Calls f(index in the file, index from this field's first parameter on).
  template <class F>
  void OverNumbers(const F& f) const {
    std::size_t in_file = 0;
    for (int m = 0; m < matrices; ++m) {
      for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c, ++in_file)
          f(in_file, static_cast<std::size_t>((std::int64_t{m} * columns + c) * rows + r));
      }
    }
  }
  std::size_t size() const {
    return static_cast<std::size_t>(matrices) * static_cast<std::size_t>(rows) *
           static_cast<std::size_t>(columns);
  }
};

// In the order of the parameters.
std::vector<Layer> LayersOf(const NetworkShape& s) {
  std::vector<Layer> layers = {
      {&Weights::hidden_weight, {s.networks, s.hidden, s.inputs}, 1, s.units(), s.inputs},
      {&Weights::hidden_bias, {s.networks, s.hidden}, 1, s.units(), 1}};
  if (s.hidden_2 > 0) {
    layers.push_back(
        {&Weights::hidden_2_weight, {s.networks, s.hidden_2, s.hidden}, s.networks, s.hidden_2, s.hidden});
    layers.push_back({&Weights::hidden_2_bias, {s.networks, s.hidden_2}, 1, s.last_units(), 1});
  }
  layers.push_back({&Weights::output_weight, {s.networks, s.last()}, 1, s.last_units(), 1});
  layers.push_back({&Weights::output_bias, {s.networks}, 1, s.networks, 1});
  return layers;
}

}  // namespace

Weights WeightsOf(const Parameters<float>& parameters) {
  Weights file;
  const float* from = parameters.values.data();
  for (const Layer& layer : LayersOf(parameters.shape)) {
    std::vector<double> numbers(layer.size());
    layer.OverNumbers([&](std::size_t in_file, std::size_t at) { numbers[in_file] = from[at]; });
    file.*layer.array = {layer.shape, numbers};
    from += layer.size();
  }
  return file;
}

Parameters<double> NetworksIn(const Weights& file) {
  Parameters<double> parameters(ShapeIn(file));
  double* to = parameters.values.data();
  for (const Layer& layer : LayersOf(parameters.shape)) {
    const Column<double>& numbers = file.*layer.array;
    if (numbers.shape() != layer.shape)
      throw InputError("'" + numbers.name() + "' is not of as many units as the last hidden layer has");
    layer.OverNumbers([&](std::size_t in_file, std::size_t at) { to[at] = numbers[in_file]; });
    to += layer.size();
  }
  return parameters;
}

}  // namespace cairn::landmark_learning
