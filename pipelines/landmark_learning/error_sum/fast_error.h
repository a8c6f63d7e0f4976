// E_posterior and its gradient without a loop over pairs, where the products with e and Bel_prior can be had
// for less.
#pragma once

#include <limits>
#include <vector>

#include "pipelines/landmark_learning/error_sum/posterior_error.h"

namespace cairn::landmark_learning {

// Samples that lie on a line, at x_m, y_m zero, or anywhere if the belief is global and the error `along` or
// `squared`: by LineSums, in double. Otherwise as ErrorOfTruePositions. The belief is uniform.
template <class Real>
ErrorShare<Real> ErrorOnLine(const Positions& positions, const Belief& belief, ErrorKind error,
                             const std::vector<Real>& probability, int vectors,
                             const std::vector<double>& weight, const IndexRange& true_positions);

// Samples anywhere in the plane, the belief global, the error the distance: by TreeSums. Each distance, hence
// each N and E, is off by at most kFarBound of itself; the gradient is exactly that of this E.
template <class Real>
ErrorShare<Real> ErrorInPlane(const Positions& positions, const std::vector<Real>& probability, int vectors,
                              const std::vector<double>& weight, const IndexRange& true_positions);

}  // namespace cairn::landmark_learning
