#include "pipelines/landmark_learning/networks/some_networks.h"

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

// Columns from `first` on of a table [rows][width].
template <class Real>
std::vector<Real> ColumnsFrom(int first, const std::vector<Real>& table, int width) {
  std::vector<Real> some;
  for (auto row = table.begin(); row != table.end(); row += width)
    some.insert(some.end(), row + first, row + width);
  return some;
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

template <class Real>
Parameters<Real> BackwardFrom(int first, const Parameters<Real>& parameters, const Real* inputs, int rows,
                              const Activations<Real>& activations, const std::vector<Real>& d_output) {
  if (first == 0) return Backward(parameters, inputs, rows, activations, d_output);
  const NetworkShape& s = parameters.shape;
  Activations<Real> own{ColumnsFrom(first * s.hidden, activations.hidden, s.units()),
                        ColumnsFrom(first * s.hidden_2, activations.second, s.networks * s.hidden_2),
                        ColumnsFrom(first, activations.output, s.networks)};
  return Backward(SomeNetworks(parameters, first, s.networks), inputs, rows, own,
                  ColumnsFrom(first, d_output, s.networks));
}

template Parameters<float> SomeNetworks(const Parameters<float>&, int, int);
template Parameters<double> SomeNetworks(const Parameters<double>&, int, int);
template void PutNetworks(const Parameters<float>&, int, Parameters<float>*);
template void PutNetworks(const Parameters<double>&, int, Parameters<double>*);
template Parameters<float> BackwardFrom(int, const Parameters<float>&, const float*, int,
                                        const Activations<float>&, const std::vector<float>&);
template Parameters<double> BackwardFrom(int, const Parameters<double>&, const double*, int,
                                         const Activations<double>&, const std::vector<double>&);

}  // namespace cairn::landmark_learning
