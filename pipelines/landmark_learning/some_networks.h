// Some of the networks, as ones of their own.
#pragma once

#include <vector>

#include "pipelines/landmark_learning/networks.h"

namespace cairn::landmark_learning {

// Networks first <= i < end of `all`.
template <class Real>
Parameters<Real> SomeNetworks(const Parameters<Real>& all, int first, int end);

// Puts `some` back as the networks from `first` on.
template <class Real>
void PutNetworks(const Parameters<Real>& some, int first, Parameters<Real>* all);

}  // namespace cairn::landmark_learning
