#include "datasets/import/timed_inputs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "datasets/import/csv_reader.h"
#include "datasets/import/row_times.h"
#include "schema/error.h"

namespace cairn::datasets {

TimedInputs::TimedInputs(const std::string& path, BadLines* bad) {
  CsvReader reader(path, {{"time_s", "run"}, {"time_s"}}, bad);
  reader.TakeExtraColumns();
  names_ = reader.extra_columns();
  if (names_.empty())
    throw InputError(reader.Place() + "the header has no inputs: columns beside time_s, run");
  has_runs_ = reader.header() == 0;
  const std::size_t first = has_runs_ ? 2 : 1;
  const std::optional<std::size_t> run = has_runs_ ? std::optional<std::size_t>(1) : std::nullopt;
  while (reader.Next()) {
    const std::optional<double> time = reader.Number(0);
    if (!time) continue;
    Rows& rows = rows_[has_runs_ ? std::string(reader.Text(1)) : ""];
    if (!rows.time_s.empty() && !InTimeOrder(*time, rows.time_s.back(), 0, run, "", &reader)) continue;
    std::vector<float> input;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::optional<double> value = reader.Number(first + i);
      if (!value) break;
      if (std::abs(*value) > std::numeric_limits<float>::max()) {
        reader.Bad("too large for 32 bits", std::string(reader.Text(first + i)));
        break;
      }
      input.push_back(static_cast<float>(*value));
    }
    if (input.size() < names_.size()) continue;
    rows.time_s.push_back(*time);
    rows.input.insert(rows.input.end(), input.begin(), input.end());
  }
}

std::span<const float> TimedInputs::Nearest(const std::string& run, double time_s, double most_s) const {
  const auto found = rows_.find(has_runs_ ? run : "");
  if (found == rows_.end()) return {};
  const std::vector<double>& times = found->second.time_s;
  auto nearest = std::ranges::lower_bound(times, time_s);
  if (nearest == times.end() || (nearest != times.begin() && time_s - *(nearest - 1) <= *nearest - time_s)) {
    if (nearest == times.begin()) return {};
    --nearest;
  }
  if (std::abs(*nearest - time_s) > most_s) return {};
  const auto row = static_cast<std::size_t>(nearest - times.begin());
  return std::span(found->second.input).subspan(row * names_.size(), names_.size());
}

}  // namespace cairn::datasets
