// The square of a number, by one name.
#pragma once

namespace cairn {

constexpr double Square(double x) { return x * x; }

}  // namespace cairn
