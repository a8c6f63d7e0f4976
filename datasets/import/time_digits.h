// Whether times were written with the digits that they need.
#pragma once

#include <cstddef>
#include <string>

namespace cairn::datasets {

// The times of one robot's rows, in order.
class TimeDigits {
 public:
  void Add(double time_s);
  // "4001 rows have 1 time: were they written with too few digits?" where that is so of all rows, or where
  // fifty and more have one and the next is seconds later; else empty.
  std::string Doubt() const;

 private:
  std::size_t rows_ = 0, times_ = 0;
  double first_s_ = 0, last_s_ = 0;
};

}  // namespace cairn::datasets
