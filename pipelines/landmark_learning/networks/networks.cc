#include "pipelines/landmark_learning/networks/networks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pipelines/landmark_learning/error_sum/feature_rows.h"
#include "pipelines/landmark_learning/error_sum/lane_math.h"
#include "pipelines/landmark_learning/networks/second_layer.h"

namespace cairn::landmark_learning {
namespace {

constexpr int kPieceRows = 64;  // whose inputs stay in the nearest caches

// Calls f<registers>(first unit) so that all units are covered, three registers at a time or fewer.
template <class Real, class F>
void OverUnits(int width, const F& f) {
  constexpr int kCount = Lanes<Real>::kCount;
  int at = 0;
  for (; at + 3 * kCount <= width; at += 3 * kCount) f.template operator()<3>(at);
  for (; at + 2 * kCount <= width; at += 2 * kCount) f.template operator()<2>(at);
  for (; at < width; at += kCount) f.template operator()<1>(at);
}

// Covers `count` by fours, then by single ones.
template <class F>
void InFours(int count, const F& f) {
  int at = 0;
  for (; at + 4 <= count; at += 4) f.template operator()<4>(at);
  for (; at < count; ++at) f.template operator()<1>(at);
}

// [rows][units] with each row filled up to whole registers.
template <class Real>
std::vector<Real> Widened(const Real* rows, int count, int units) {
  const int width = WidthOf<Real>(units);
  std::vector<Real> wide(static_cast<std::size_t>(count) * static_cast<std::size_t>(width), Real(0));
  for (int i = 0; i < count; ++i)
    std::copy_n(rows + static_cast<std::ptrdiff_t>(i) * units, units, RowOf(wide, i, width));
  return wide;
}

// sums[row][u] = biases[u] + sum_i inputs[row][i] weights[i][u] for kRows rows of inputs.
template <class Real, int kRows, int kRegisters>
void WeighBlock(const Real* inputs, int count, const Real* weights, const Real* biases, int width,
                Real* sums) {
  using L = Lanes<Real>;
  typename L::Register sum[kRows][kRegisters];
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) sum[r][l] = L::Load(biases + l * L::kCount);
  }
  for (int i = 0; i < count; ++i, weights += width) {
    typename L::Register weight[kRegisters];
    for (int l = 0; l < kRegisters; ++l) weight[l] = L::Load(weights + l * L::kCount);
    for (int r = 0; r < kRows; ++r) {
      const auto input = L::Broadcast(inputs[static_cast<std::ptrdiff_t>(r) * count + i]);
      for (int l = 0; l < kRegisters; ++l) sum[r][l] = L::Fma(input, weight[l], sum[r][l]);
    }
  }
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kRegisters; ++l) L::Store(sums + r * width + l * L::kCount, sum[r][l]);
  }
}

// gradients[i][u] += sum_row inputs[row][i] d_unit[row][u] for kInputs inputs.
template <class Real, int kInputs, int kRegisters>
void GradientBlock(const Real* inputs, int count, int rows, const Real* d_unit, int width, Real* by_weights) {
  using L = Lanes<Real>;
  typename L::Register sum[kInputs][kRegisters];
  for (int i = 0; i < kInputs; ++i) {
    for (int l = 0; l < kRegisters; ++l) sum[i][l] = L::Load(by_weights + i * width + l * L::kCount);
  }
  for (int row = 0; row < rows; ++row, inputs += count, d_unit += width) {
    typename L::Register d[kRegisters];
    for (int l = 0; l < kRegisters; ++l) d[l] = L::Load(d_unit + l * L::kCount);
    for (int i = 0; i < kInputs; ++i) {
      const auto input = L::Broadcast(inputs[i]);
      for (int l = 0; l < kRegisters; ++l) sum[i][l] = L::Fma(input, d[l], sum[i][l]);
    }
  }
  for (int i = 0; i < kInputs; ++i) {
    for (int l = 0; l < kRegisters; ++l) L::Store(by_weights + i * width + l * L::kCount, sum[i][l]);
  }
}

// From dE/dg of rows to the gradients by what goes into each unit of the last hidden layer, and by the output
// units' weights and biases. `width`: last_units in whole registers.
template <class Real>
class OutputLayer {
 public:
  OutputLayer(const Parameters<Real>& parameters, int width)
      : shape_(parameters.shape),
        weights_(Widened(parameters.OutputWeights(), 1, shape_.last_units())),
        hidden_(static_cast<std::size_t>(width)),
        d_sum_(static_cast<std::size_t>(width)),
        gradient_by_weights_(static_cast<std::size_t>(width)) {}

  // One row: fills d_unit[0 … width).
  void Back(const Real* hidden, const Real* output, const Real* d_output, Real* biases, Real* d_unit) {
    using L = Lanes<Real>;
    std::copy_n(hidden, shape_.last_units(), hidden_.begin());
    for (int n = 0; n < shape_.networks; ++n) {
      // [Thr98] eq. 39, backpropagation
      const Real d_sum = d_output[n] * output[n] * (Real(1) - output[n]);
      biases[n] += d_sum;
      std::fill_n(d_sum_.begin() + n * shape_.last(), shape_.last(), d_sum);
    }
    const auto one = L::Broadcast(Real(1));
    for (std::size_t u = 0; u < hidden_.size(); u += L::kCount) {
      const auto h = L::Load(&hidden_[u]), d_sum = L::Load(&d_sum_[u]);
      L::Store(&gradient_by_weights_[u], L::Fma(d_sum, h, L::Load(&gradient_by_weights_[u])));
      L::Store(d_unit + u, L::Mul(L::Mul(L::Mul(d_sum, L::Load(&weights_[u])), h), L::Sub(one, h)));
    }
  }
  const std::vector<Real>& by_weights() const { return gradient_by_weights_; }  // by the weights, [width]

 private:
  NetworkShape shape_;
  std::vector<Real> weights_, hidden_, d_sum_, gradient_by_weights_;
};

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
  const int units = shape.units(), width = WidthOf<Real>(units);
  const auto weights = Widened(parameters.HiddenWeights(0), shape.inputs, units);
  const auto biases = Widened(parameters.HiddenBiases(), 1, units);
  Activations<Real> out;
  out.hidden.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(units));
  out.output.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(shape.networks));
  std::vector<Real> sums(4 * static_cast<std::size_t>(width));
  InFours(rows, [&]<int kRows>(int row) {
    OverUnits<Real>(width, [&]<int kRegisters>(int u) {
      WeighBlock<Real, kRows, kRegisters>(inputs + static_cast<std::ptrdiff_t>(row) * shape.inputs,
                                          shape.inputs, &weights[static_cast<std::size_t>(u)],
                                          &biases[static_cast<std::size_t>(u)], width,
                                          &sums[static_cast<std::size_t>(u)]);
    });
    for (int r = 0; r < kRows; ++r) {
      SigmoidOfAll(units, RowOf(sums, r, width));
      std::copy_n(RowOf(sums, r, width), units, RowOf(out.hidden, row + r, units));
    }
  });
  if (shape.hidden_2 > 0) out.second = SecondLayer(parameters, out.hidden, rows);
  const Real* last = out.last().data();
  Real* output = out.output.data();
  for (int row = 0; row < rows; ++row, last += shape.last_units()) {
    for (int n = 0; n < shape.networks; ++n) {
      Real sum = parameters.OutputBiases()[n];
      for (int u = n * shape.last(); u < (n + 1) * shape.last(); ++u)
        // [Thr98] eqs 30, 31
        sum = std::fma(parameters.OutputWeights()[u], last[u], sum);
      *output++ = sum;
    }
  }
  SigmoidOfAll(static_cast<int>(out.output.size()), out.output.data());
  return out;
}

template <class Real>
Parameters<Real> Backward(const Parameters<Real>& parameters, const Real* inputs, int rows,
                          const Activations<Real>& activations, const std::vector<Real>& d_output) {
  const NetworkShape& shape = parameters.shape;
  const int units = shape.units(), width = WidthOf<Real>(units);
  const int last_units = shape.last_units();
  Parameters<Real> gradient(shape);
  OutputLayer<Real> output_layer(parameters, WidthOf<Real>(last_units));
  std::vector<Real> d_last(static_cast<std::size_t>(WidthOf<Real>(last_units)));
  std::vector<Real> d_unit(kPieceRows * static_cast<std::size_t>(width)),
      biases(static_cast<std::size_t>(width));
  std::vector<Real> by_weights(static_cast<std::size_t>(shape.inputs) * static_cast<std::size_t>(width));
  for (int first = 0; first < rows; first += kPieceRows) {
    const int count = std::min(kPieceRows, rows - first);
    for (int row = first; row < first + count; ++row) {
      Real* d = RowOf(d_unit, row - first, width);
      output_layer.Back(RowOf(activations.last(), row, last_units),
                        RowOf(activations.output, row, shape.networks), RowOf(d_output, row, shape.networks),
                        gradient.OutputBiases(), shape.hidden_2 > 0 ? d_last.data() : d);
      if (shape.hidden_2 > 0)
        BackThroughSecond(parameters, RowOf(activations.hidden, row, units), d_last.data(), &gradient, d);
      AddRow(width, d, biases.data());
    }
    const Real* piece = inputs + static_cast<std::ptrdiff_t>(first) * shape.inputs;
    InFours(shape.inputs, [&]<int kInputs>(int i) {
      OverUnits<Real>(width, [&]<int kRegisters>(int u) {
        GradientBlock<Real, kInputs, kRegisters>(piece + i, shape.inputs, count,
                                                 &d_unit[static_cast<std::size_t>(u)], width,
                                                 RowOf(by_weights, i, width) + u);
      });
    });
  }
  for (int i = 0; i < shape.inputs; ++i)
    std::copy_n(RowOf(by_weights, i, width), units, gradient.HiddenWeights(i));
  std::copy_n(biases.begin(), units, gradient.HiddenBiases());
  std::copy_n(output_layer.by_weights().begin(), last_units, gradient.OutputWeights());
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
