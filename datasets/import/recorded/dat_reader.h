// Columns of numbers between blanks, with comments that begin with '#'.
#pragma once

#include <string>
#include <vector>

#include "datasets/common/text_file.h"

namespace cairn::datasets {

class DatReader {
 public:
  // Reads the file (plain or gzipped).
  // Throws InputError where it cannot be read.
  DatReader(const std::string& path, std::size_t columns, BadLines* bad);
  DatReader(const DatReader&) = delete;
  DatReader& operator=(const DatReader&) = delete;

  // Goes to the next row of `columns` numbers; other rows are bad, empty ones and comments are passed over.
  bool Next();
  std::size_t line() const { return lines_.number(); }
  double operator[](std::size_t column) const { return numbers_[column]; }
  // Calls the line bad.
  void Bad(const std::string& reason, const std::string& detail);
  // Whether column 0, the time, goes on from the row before; the line is bad where it runs backwards.
  bool InOrder();

 private:
  bool Parse();

  std::string path_, text_;
  Lines lines_;
  std::size_t columns_;
  BadLines* bad_;
  std::vector<double> numbers_;
  bool begun_ = false;
  double last_time_ = 0;
};

}  // namespace cairn::datasets
