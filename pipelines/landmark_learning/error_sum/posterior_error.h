// BaLL's target ([Thr98] eqs 36 and 37) and its exact gradient, a block of true positions at a time. With
// G[k,f] = P(f | s_k) and B[a,k] = Bel_prior(xi_k) where a is true,
//
//   E = sum_a P(a) sum_f G[a,f] N[a,f] / Z[a,f],   N = (e B) G,   Z = B G:
//
// the sum over all triples of (42), but at K^2 2^n. Of kPosteriorMass e is a bell around the truth, so that N
// / Z is the posterior's mass there, and the term is G cost(N / Z). No matrix of K x K is ever held: e and B
// are made tile by tile.
#pragma once

#include <vector>

#include "pipelines/landmark_learning/error_sum/pairs.h"

namespace cairn::landmark_learning {

// A block's share of the sums over all true positions.
template <class Real>
struct ErrorShare {
  double posterior = 0.0;           // of E_posterior, in the error's unit
  std::vector<Real> d_probability;  // [samples][2^n]: of dE_posterior/dG; zero out of the block's reach
};

// True positions and samples are one set. `probability`: G, [samples][vectors]; `weight`: P(a), [samples].
// Where Z is zero nothing is left of G[a,f] either, and the term is zero.
template <class Real>
ErrorShare<Real> ErrorOfTruePositions(const Pairs& pairs, const std::vector<Real>& probability, int vectors,
                                      const std::vector<double>& weight, const IndexRange& true_positions);

// The error alone, true positions and samples each of a set of their own: `of_truth`: P(f | what is sensed at
// a), `of_sample`: P(f | xi), a map. A feature vector that the map holds for impossible everywhere leaves the
// belief as it was.
template <class Real>
double ErrorInMap(const Pairs& pairs, const std::vector<Real>& of_truth, const std::vector<Real>& of_sample,
                  int vectors, const std::vector<double>& weight, const IndexRange& true_positions);

// A block's share of E_prior ([Thr98] eq. 21): the same where nothing is sensed.
double PriorErrorOfTruePositions(const Pairs& pairs, const std::vector<double>& weight,
                                 const IndexRange& true_positions);

}  // namespace cairn::landmark_learning
