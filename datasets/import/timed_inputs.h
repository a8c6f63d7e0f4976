// Readings of other sensors (ranges, say), each with its time: what was read nearest to a moment.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "datasets/common/text_file.h"

namespace cairn::datasets {

class TimedInputs {
 public:
  // `time_s[,run]` and any other columns, each an input; plain or gzipped; without `run` the rows serve all
  // runs. Bad lines: a number that is none or too large for 32 bits, a time that runs backwards.
  // Throws InputError "FILE:LINE: REASON" where there are no inputs.
  TimedInputs(const std::string& path, BadLines* bad);

  const std::vector<std::string>& names() const { return names_; }
  // The row nearest to `time_s`, the earlier of two; empty where none is within `most_s`.
  std::span<const float> Nearest(const std::string& run, double time_s, double most_s) const;

 private:
  struct Rows {
    std::vector<double> time_s;
    std::vector<float> input;  // [rows][names]
  };
  std::vector<std::string> names_;
  std::map<std::string, Rows> rows_;  // by run; "" where they serve all
  bool has_runs_ = false;
};

}  // namespace cairn::datasets
