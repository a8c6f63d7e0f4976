#include "tests/mutation/selftest/sample.h"

#include <algorithm>

namespace cairn::mutation {

double Shared(double a_low_m, double a_high_m, double b_low_m, double b_high_m) {
  const double shared_m = std::min(a_high_m, b_high_m) - std::max(a_low_m, b_low_m);
  return shared_m > 0.0 ? shared_m : 0.0;
}

double ShareOfFirst(double a_low_m, double a_high_m, double b_low_m, double b_high_m) {
  return Shared(a_low_m, a_high_m, b_low_m, b_high_m) / (a_high_m - a_low_m);
}

}  // namespace cairn::mutation
