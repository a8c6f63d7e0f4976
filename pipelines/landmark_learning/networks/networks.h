// The feature extractors: n networks, each with one hidden layer or two and one output, sigmoid throughout
// ([Thr98] sections 4.1 and 5.1.4, schema/FORMAT.md).
#pragma once

#include <cstdint>
#include <vector>

#include "schema/rng.h"

namespace cairn::landmark_learning {

struct NetworkShape {
  int networks = 1, inputs = 1, hidden = 1;
  int hidden_2 = 0;  // units of the second hidden layer; 0: there is none

  int units() const { return networks * hidden; }                // of the first hidden layer, of all networks
  int last() const { return hidden_2 > 0 ? hidden_2 : hidden; }  // units that the output sees
  int last_units() const { return networks * last(); }           // of all networks
  std::size_t second_weights() const {                           // of all networks
    return static_cast<std::size_t>(units()) * static_cast<std::size_t>(hidden_2);
  }
  std::size_t parameters() const {
    return static_cast<std::size_t>(units()) * (static_cast<std::size_t>(inputs) + 1) + second_weights() +
           static_cast<std::size_t>(networks) * static_cast<std::size_t>(hidden_2) +
           static_cast<std::size_t>(last_units()) + static_cast<std::size_t>(networks);
  }
  friend bool operator==(const NetworkShape&, const NetworkShape&) = default;
};

// One vector, as optimisers want it, or a gradient by it. In this order: hidden weights [inputs][units],
// hidden biases [units], the second layer's weights [networks][hidden][hidden_2] and biases [networks *
// hidden_2], output weights [last_units], output biases [networks]; unit i * hidden + h is unit h of network
// i.
template <class Real>
struct Parameters {
  NetworkShape shape;
  std::vector<Real> values;

  explicit Parameters(const NetworkShape& s) : shape(s), values(s.parameters(), Real(0)) {}
  Real* HiddenWeights(int input) { return &values[static_cast<std::size_t>(input) * Units()]; }
  Real* HiddenBiases() { return &values[static_cast<std::size_t>(shape.inputs) * Units()]; }
  Real* SecondWeights() { return HiddenBiases() + Units(); }
  Real* SecondBiases() { return SecondWeights() + shape.second_weights(); }
  Real* OutputWeights() { return SecondBiases() + SecondUnits(); }
  Real* OutputBiases() { return OutputWeights() + shape.last_units(); }
  const Real* HiddenWeights(int input) const { return &values[static_cast<std::size_t>(input) * Units()]; }
  const Real* HiddenBiases() const { return &values[static_cast<std::size_t>(shape.inputs) * Units()]; }
  const Real* SecondWeights() const { return HiddenBiases() + Units(); }
  const Real* SecondBiases() const { return SecondWeights() + shape.second_weights(); }
  const Real* OutputWeights() const { return SecondBiases() + SecondUnits(); }
  const Real* OutputBiases() const { return OutputWeights() + shape.last_units(); }

 private:
  std::size_t Units() const { return static_cast<std::size_t>(shape.units()); }
  std::size_t SecondUnits() const {
    return static_cast<std::size_t>(shape.networks) * static_cast<std::size_t>(shape.hidden_2);
  }
};

// "Small random values" ([Thr98] table 2): uniform in +-`width`, drawn in the order of the vector.
template <class Real>
Parameters<Real> RandomParameters(const NetworkShape& shape, double width, Rng& rng);

// What the networks make of rows of inputs.
template <class Real>
struct Activations {
  std::vector<Real> hidden;  // [rows][units]
  std::vector<Real> second;  // [rows][networks * hidden_2]
  std::vector<Real> output;  // [rows][networks]: g

  const std::vector<Real>& last() const { return second.empty() ? hidden : second; }  // [rows][last_units]
};

// `inputs`: [rows][inputs], normalised.
template <class Real>
Activations<Real> Forward(const Parameters<Real>& parameters, const Real* inputs, int rows);

// dE/dw from dE/dg: [rows][networks] (backpropagation; rows add up in their order).
template <class Real>
Parameters<Real> Backward(const Parameters<Real>& parameters, const Real* inputs, int rows,
                          const Activations<Real>& activations, const std::vector<Real>& d_output);

}  // namespace cairn::landmark_learning
