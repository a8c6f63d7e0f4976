#include "pipelines/landmark_learning/optimizer/patterns.h"

#include <algorithm>

#include "schema/error.h"

namespace cairn::landmark_learning {

float PatternTarget(float g, double step, double slope) {
  constexpr double kWithin = 1e-3;  // a sigmoid never gets to 0 or 1, and is flat long before
  // [Thr98] eq. 45
  return static_cast<float>(std::clamp(g - step * slope, kWithin, 1.0 - kWithin));
}

std::vector<double> FitPatterns(const NetworkShape& shape, std::vector<double> weights, const float* inputs,
                                const std::vector<float>& target, const DescentRules& rules,
                                std::int64_t steps, Progress& progress) {
  CAIRN_DEMAND(shape.networks == 1, "networks are fitted one by one");
  const auto rows = static_cast<int>(target.size());
  Descent descent;
  Parameters<float> rounded(shape);
  std::vector<float> d_output(target.size());
  for (std::int64_t step = 0; step < steps; ++step) {
    progress.Tick();
    std::ranges::transform(weights, rounded.values.begin(), [](double w) { return static_cast<float>(w); });
    const auto activations = Forward(rounded, inputs, rows);
    for (std::size_t k = 0; k < target.size(); ++k)
      d_output[k] = (activations.output[k] - target[k]) / static_cast<float>(rows);
    const auto gradient = Backward(rounded, inputs, rows, activations, d_output);
    descent.Step(rules, {gradient.values.begin(), gradient.values.end()}, &weights);
  }
  return weights;
}

}  // namespace cairn::landmark_learning
