#include "pipelines/landmark_learning/some_networks.h"

#include <algorithm>

#include "schema/error.h"

namespace cairn::landmark_learning {
namespace {

// Calls f(numbers of `all`, numbers of `some`, count) for each stretch that both hold.
template <class All, class Some, class F>
void InStretches(All& all, int first, Some& some, const F& f) {
  const NetworkShape &each = all.shape, &shape = some.shape;
  const int from = first * each.hidden, units = shape.units();
  for (int i = 0; i < all.shape.inputs; ++i) f(all.HiddenWeights(i) + from, some.HiddenWeights(i), units);
  f(all.HiddenBiases() + from, some.HiddenBiases(), units);
  f(all.SecondWeights() + from * each.hidden_2, some.SecondWeights(), units * each.hidden_2);
  f(all.SecondBiases() + first * each.hidden_2, some.SecondBiases(), shape.networks * each.hidden_2);
  f(all.OutputWeights() + first * each.last(), some.OutputWeights(), shape.last_units());
  f(all.OutputBiases() + first, some.OutputBiases(), shape.networks);
}

}  // namespace

template <class Real>
Parameters<Real> SomeNetworks(const Parameters<Real>& all, int first, int end) {
  CAIRN_DEMAND(first >= 0 && first < end && end <= all.shape.networks, "networks that there are");
  NetworkShape shape = all.shape;
  shape.networks = end - first;
  Parameters<Real> some(shape);
  InStretches(all, first, some, [](const Real* from, Real* to, int n) { std::copy_n(from, n, to); });
  return some;
}

template <class Real>
void PutNetworks(const Parameters<Real>& some, int first, Parameters<Real>* all) {
  InStretches(*all, first, some, [](Real* to, const Real* from, int n) { std::copy_n(from, n, to); });
}

template Parameters<float> SomeNetworks(const Parameters<float>&, int, int);
template Parameters<double> SomeNetworks(const Parameters<double>&, int, int);
template void PutNetworks(const Parameters<float>&, int, Parameters<float>*);
template void PutNetworks(const Parameters<double>&, int, Parameters<double>*);

}  // namespace cairn::landmark_learning
