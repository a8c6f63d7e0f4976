// A line as fields between blanks, or commas.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/common/text_file.h"
#include "schema/geometry.h"

namespace cairn::datasets {

// Why a line cannot be used, as BadLines::Add takes it.
struct LineError {
  std::string reason, detail;
};

// Of a line whose first word, of which the beginning is said, names no message that the format has.
LineError UnknownMessage(std::string_view name);

class Fields {
 public:
  explicit Fields(std::string_view line, bool by_commas = false);
  std::size_t size() const { return fields_.size(); }
  bool empty() const { return fields_.empty(); }
  // These throw LineError: where there is no such field, "line cut short"; for numbers as ParseNumber says.
  std::string_view Text(std::size_t field) const;
  double Number(std::size_t field) const;
  // A coordinate, `per_m` units of length a metre; beyond 10,000 km "no place on Earth".
  double Place(std::size_t field, double per_m = 1) const;
  // A pose x, y, heading; beyond a million radians "no heading".
  Pose PoseAt(std::size_t first, double per_m = 1) const;
  // A time, `per_s` units a second; beyond 4.2e9 s (Unix time of 2103), where a double has no microseconds,
  // "no time stamp".
  double Stamp(std::size_t field, double per_s = 1) const;
  // A whole number of 0 to `most`; else "no count".
  std::size_t Count(std::size_t field, std::size_t most) const;
  // `count` ranges from `first` on, each from 0 to `most_m`; else "negative range", "beyond any sensor's
  // reach", "range is not finite", "range is not a number".
  std::vector<double> Ranges(std::size_t first, std::size_t count, double most_m) const;
  // That there are `needed` fields, since the line declares so many of something: `declared`.
  void Need(std::size_t needed, const std::string& declared) const;

 private:
  double Within(std::size_t field, double per, double most, const char* otherwise) const;

  std::vector<std::string_view> fields_;
};

// Hands each line of the file (plain or gzipped) that is neither empty nor a comment ('#') to `read`, with
// its number; one of which it throws LineError is bad.
void ForEachLine(const std::string& path, BadLines* bad,
                 const std::function<void(const Fields&, std::size_t)>& read, bool by_commas = false);

}  // namespace cairn::datasets
