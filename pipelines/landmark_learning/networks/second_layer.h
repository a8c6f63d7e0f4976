// The second hidden layer of networks that have one: its units see the first layer's of their own network.
#pragma once

#include <vector>

#include "pipelines/landmark_learning/networks/networks.h"

namespace cairn::landmark_learning {

// The layer's outputs: [rows][networks * hidden_2]. `hidden`: the first layer's, [rows][units].
template <class Real>
std::vector<Real> SecondLayer(const Parameters<Real>& parameters, const std::vector<Real>& hidden, int rows);

// Backpropagation of one row. `d_second`: gradients by what goes into the layer's units, [networks *
// hidden_2]. Adds those by the layer's weights and biases to `gradient`; d_hidden becomes those by what goes
// into the first layer's units, [units].
template <class Real>
void BackThroughSecond(const Parameters<Real>& parameters, const Real* hidden, const Real* d_second,
                       Parameters<Real>* gradient, Real* d_hidden);

}  // namespace cairn::landmark_learning
