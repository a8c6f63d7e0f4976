// Rows come in order of their times.
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

}  // namespace cairn::datasets
