// The times of a table's rows: that they come in order, and were written with the digits that they need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "datasets/import/csv_reader.h"
#include "schema/walked.h"

namespace cairn::datasets {

// What to do about times that run backwards, for a message.
inline constexpr char kSortRows[] = "sort the rows by time";

// The likely cause where rows that follow each other have one time, or a time lies just beyond another
// table's.
inline constexpr char kWholeSeconds[] =
    "are times rounded to whole seconds? Give them with fractions of a second";

// "; are times rounded …" where a row has the time of the one before, and that may be why; else empty.
std::string HintOfSameTime(double time_s, double last_s);
// Whether there are several, and all are.
bool AreWholeSeconds(const Walked<double>& time_s);
// The same of all rows of a file, wherever the reader is.
bool AreWholeSeconds(const CsvReader& reader, std::size_t time);

// Of a robot's observations: "41 of 428 rows are of a landmark that another row is of at the same time, all
// times whole seconds: are times rounded …" where that is so of a good part of them; else empty.
std::string DoubtRepeats(std::span<const double> time_s, std::span<const std::int32_t> landmark);

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
  // "3000 rows have 301 times, all whole seconds: are times rounded …" where that is so; else empty. What
  // moved within a second is not lost, but when is.
  std::string Rounded() const;

 private:
  std::string Count() const;

  std::size_t rows_ = 0, times_ = 0;
  bool are_whole_ = true;
  double first_s_ = 0, last_s_ = 0;
};

}  // namespace cairn::datasets
