// The times of a table's rows: that they come in order, and were written with the digits that they need.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "datasets/import/csv_reader.h"

namespace cairn::datasets {

// What to do about times that run backwards, for a message.
inline constexpr char kSortRows[] = "sort the rows by time";

// Whether the row at `time_s` may follow one at `last_s`; the line is bad where it may not, and the message
// says to sort the rows where those of a good part of the file would be skipped. `time` and `robot`: columns
// of the reader's header; each robot's times are in an order of their own. `hint` ends the message.
bool InTimeOrder(double time_s, double last_s, std::size_t time, std::optional<std::size_t> robot,
                 const std::string& hint, CsvReader* reader);

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
