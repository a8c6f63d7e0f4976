// The feature extractors: n networks, each with one hidden layer and one output, sigmoid throughout ([T98]
// section 4.1, schema/FORMAT.md).
#pragma once

#include <cstdint>
#include <vector>

#include "schema/rng.h"

namespace cairn::landmark_learning {

struct NetworkShape {
  int networks = 1, inputs = 1, hidden = 1;

  int units() const { return networks * hidden; }  // hidden ones, of all networks
  std::size_t parameters() const {
    return static_cast<std::size_t>(units()) * (static_cast<std::size_t>(inputs) + 2) +
           static_cast<std::size_t>(networks);
  }
  friend bool operator==(const NetworkShape&, const NetworkShape&) = default;
};

// One vector, as optimisers want it, or a gradient by it. In this order: hidden weights [inputs][units],
// hidden biases [units], output weights [units], output biases [networks]; unit i * hidden + h is unit h of
// network i.
template <class Real>
struct Parameters {
  NetworkShape shape;
  std::vector<Real> values;

  explicit Parameters(const NetworkShape& s) : shape(s), values(s.parameters(), Real(0)) {}
  Real* HiddenWeights(int input) { return &values[static_cast<std::size_t>(input) * Units()]; }
  Real* HiddenBiases() { return &values[static_cast<std::size_t>(shape.inputs) * Units()]; }
  Real* OutputWeights() { return HiddenBiases() + Units(); }
  Real* OutputBiases() { return OutputWeights() + Units(); }
  const Real* HiddenWeights(int input) const { return &values[static_cast<std::size_t>(input) * Units()]; }
  const Real* HiddenBiases() const { return &values[static_cast<std::size_t>(shape.inputs) * Units()]; }
  const Real* OutputWeights() const { return HiddenBiases() + Units(); }
  const Real* OutputBiases() const { return OutputWeights() + Units(); }

 private:
  std::size_t Units() const { return static_cast<std::size_t>(shape.units()); }
};

// "Small random values" ([T98] table 2): uniform in +-`width`, drawn in the order of the vector.
template <class Real>
Parameters<Real> RandomParameters(const NetworkShape& shape, double width, Rng& rng);

// What the networks make of rows of inputs.
template <class Real>
struct Activations {
  std::vector<Real> hidden;  // [rows][units]
  std::vector<Real> output;  // [rows][networks]: g
};

// `inputs`: [rows][inputs], normalised.
template <class Real>
Activations<Real> Forward(const Parameters<Real>& parameters, const Real* inputs, int rows);

// dE/dw from dE/dg: [rows][networks] (backpropagation; rows add up in their order).
template <class Real>
Parameters<Real> Backward(const Parameters<Real>& parameters, const Real* inputs, int rows,
                          const Activations<Real>& activations, const std::vector<Real>& d_output);

}  // namespace cairn::landmark_learning
