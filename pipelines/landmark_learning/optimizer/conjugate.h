// Conjugate gradients after Polak and Ribiere (J. Hertz, A. Krogh, R. G. Palmer, Introduction to the theory
// of neural computation, 1991, section 6.2), as rounds: one computes the gradient, the next tries several
// lengths along the line at once, each a set of tasks.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "schema/blob.h"
#include "schema/kinds/fields.h"

namespace cairn::landmark_learning {

struct Conjugate {
  // Lengths that a line search tries, as multiples of `length`.
  static constexpr std::array<double, 6> kTried = {0.0625, 0.25, 0.5, 1.0, 2.0, 4.0};
  static constexpr std::int64_t kMostFailures = 4;

  std::vector<float> gradient;   // of the step before
  std::vector<float> direction;  // along which the line search goes
  double start = 0.0;            // the error where it begins
  double slope = 0.0;            // of the error along it
  double length = 0.0;           // in multiples of the direction
  std::int64_t since_restart = 0;
  std::int64_t failures = 0;  // line searches in a row without a lower error

  // Makes the next direction: -gradient + beta * (the direction before), beta = max(0, g (g - g_before) /
  // g_before^2), or -gradient alone after a failure, after as many steps as there are weights, and where it
  // does not lead down. `first_length`: root mean square of the first step's changes.
  void Turn(double error, const std::vector<double>& of_gradient, double first_length);

  // Errors of kTried. Takes the best one and returns its length, 0 where none is lower: then `length` is cut
  // for the next search.
  double Choose(const std::vector<double>& errors);
  bool Stuck() const { return failures >= kMostFailures; }
  static void Fields(const auto& field) {
    field("gradient", &Conjugate::gradient);
    field("direction", &Conjugate::direction);
    field("start", &Conjugate::start);
    field("slope", &Conjugate::slope);
    field("length", &Conjugate::length);
    field("since_restart", &Conjugate::since_restart);
    field("failures", &Conjugate::failures);
  }
};

// weights + length * direction
std::vector<double> AlongLine(std::vector<double> weights, const std::vector<float>& direction,
                              double length);

}  // namespace cairn::landmark_learning
