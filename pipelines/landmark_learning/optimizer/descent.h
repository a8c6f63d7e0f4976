// How weights follow the gradient.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/kinds/fields.h"

namespace cairn::landmark_learning {

enum class Method {
  kGradient,  // [Thr98] eq. 38
  kMomentum,  // v <- momentum v - rate dE/dw; w <- w + v
  kAdam,      // D. P. Kingma, J. Ba, Adam: a method for stochastic optimization, ICLR 2015, algorithm 1
};

struct DescentRules {
  Method method = Method::kAdam;
  double rate = 0.01, momentum = 0.9;
  double weight_decay = 0.0;  // w <- w - rate * weight_decay * w, beside the step (decoupled)
};

// The optimiser's memory. The weights are double, so that what a step changes is not lost; the memory is kept
// as float, which is half of what travels.
struct Descent {
  std::int64_t step = 0;
  std::vector<float> first, second;  // momentum, or Adam's moments; empty before the first step

  void Step(const DescentRules& rules, const std::vector<double>& gradient, std::vector<double>* weights);
  static void Fields(const auto& field) {
    field("step", &Descent::step);
    field("first", &Descent::first);
    field("second", &Descent::second);
  }
};

}  // namespace cairn::landmark_learning
