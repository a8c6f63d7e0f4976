// What --skip-bad leaves of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "datasets/common/text_file.h"

namespace cairn::datasets {

// The rows that are skipped from here on.
class SkippedRows {
 public:
  explicit SkippedRows(const BadLines& bad) : bad_(bad), before_(bad.counts()) {}
  // Throws InputError that says why where fewer rows of the file are good than were skipped: what is left of
  // such a file is seldom what its maker meant.
  void RequireHalf(const std::string& path, std::size_t good) const;

 private:
  const BadLines& bad_;
  std::map<std::string, std::int64_t> before_;
};

}  // namespace cairn::datasets
