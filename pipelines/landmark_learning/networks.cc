#include "pipelines/landmark_learning/networks.h"

#include <algorithm>
#include <cmath>

namespace cairn::landmark_learning {
namespace {

template <class Real>
Real Sigmoid(Real x) {
  return Real(1) / (Real(1) + std::exp(-x));
}

// sums[u] += factor * row[u]
template <class Real>
void AddRow(Real factor, const Real* row, int n, Real* sums) {
  for (int u = 0; u < n; ++u) sums[u] = std::fma(factor, row[u], sums[u]);
}

}  // namespace

template <class Real>
Parameters<Real> RandomParameters(const NetworkShape& shape, double width, Rng& rng) {
  Parameters<Real> parameters(shape);
  for (Real& value : parameters.values) value = static_cast<Real>(rng.Uniform(-width, width));
  return parameters;
}

template <class Real>
Activations<Real> Forward(const Parameters<Real>& parameters, const Real* inputs, int rows) {
  const NetworkShape& shape = parameters.shape;
  const int units = shape.units();
  Activations<Real> out;
  out.hidden.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(units));
  out.output.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(shape.networks));
  Real* hidden = out.hidden.data();
  Real* output = out.output.data();
  for (int row = 0; row < rows; ++row, hidden += units, inputs += shape.inputs) {
    std::copy_n(parameters.HiddenBiases(), units, hidden);
    for (int i = 0; i < shape.inputs; ++i) AddRow(inputs[i], parameters.HiddenWeights(i), units, hidden);
    for (int u = 0; u < units; ++u) hidden[u] = Sigmoid(hidden[u]);
    for (int n = 0; n < shape.networks; ++n) {
      Real sum = parameters.OutputBiases()[n];
      for (int h = n * shape.hidden; h < (n + 1) * shape.hidden; ++h)
        sum = std::fma(parameters.OutputWeights()[h], hidden[h], sum);
      *output++ = Sigmoid(sum);
    }
  }
  return out;
}

template <class Real>
Parameters<Real> Backward(const Parameters<Real>& parameters, const Real* inputs, int rows,
                          const Activations<Real>& activations, const std::vector<Real>& d_output) {
  const NetworkShape& shape = parameters.shape;
  const int units = shape.units();
  Parameters<Real> gradient(shape);
  std::vector<Real> d_unit(static_cast<std::size_t>(units));
  const Real *hidden = activations.hidden.data(), *output = activations.output.data(),
             *slope = d_output.data();
  for (int row = 0; row < rows; ++row, hidden += units, inputs += shape.inputs) {
    for (int n = 0; n < shape.networks; ++n, ++output, ++slope) {
      const Real d_sum = *slope * *output * (Real(1) - *output);
      gradient.OutputBiases()[n] += d_sum;
      for (int h = n * shape.hidden; h < (n + 1) * shape.hidden; ++h) {
        gradient.OutputWeights()[h] = std::fma(d_sum, hidden[h], gradient.OutputWeights()[h]);
        d_unit[static_cast<std::size_t>(h)] =
            d_sum * parameters.OutputWeights()[h] * hidden[h] * (Real(1) - hidden[h]);
      }
    }
    AddRow(Real(1), d_unit.data(), units, gradient.HiddenBiases());
    for (int i = 0; i < shape.inputs; ++i) AddRow(inputs[i], d_unit.data(), units, gradient.HiddenWeights(i));
  }
  return gradient;
}

template Parameters<float> RandomParameters(const NetworkShape&, double, Rng&);
template Parameters<double> RandomParameters(const NetworkShape&, double, Rng&);
template Activations<float> Forward(const Parameters<float>&, const float*, int);
template Activations<double> Forward(const Parameters<double>&, const double*, int);
template Parameters<float> Backward(const Parameters<float>&, const float*, int, const Activations<float>&,
                                    const std::vector<float>&);
template Parameters<double> Backward(const Parameters<double>&, const double*, int,
                                     const Activations<double>&, const std::vector<double>&);

}  // namespace cairn::landmark_learning
