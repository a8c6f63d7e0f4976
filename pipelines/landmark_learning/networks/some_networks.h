// Some of the networks, as ones of their own.
#pragma once

#include <vector>

#include "pipelines/landmark_learning/networks/networks.h"

namespace cairn::landmark_learning {

// Networks first <= i < end of `all`.
template <class Real>
Parameters<Real> SomeNetworks(const Parameters<Real>& all, int first, int end);

// Puts `some` back as the networks from `first` on.
template <class Real>
void PutNetworks(const Parameters<Real>& some, int first, Parameters<Real>* all);

// Backward for the networks from `first` on alone, whose gradient it returns: the same bits at their share of
// the cost. All else is of all networks.
template <class Real>
Parameters<Real> BackwardFrom(int first, const Parameters<Real>& parameters, const Real* inputs, int rows,
                              const Activations<Real>& activations, const std::vector<Real>& d_output);

}  // namespace cairn::landmark_learning
