#include "datasets/import/row_times.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

namespace cairn::datasets {
namespace {

struct Backwards {
  std::size_t rows = 0;
  std::size_t before = 0;  // that are earlier than one above them
  std::size_t steps = 0;   // that are earlier than the one right above
};

// Of the whole file, wherever the reader is.
Backwards CountBackwards(const CsvReader& reader, std::size_t time, std::optional<std::size_t> robot) {
  struct Last {
    double latest_s, above_s;
  };
  std::map<std::string, Last, std::less<>> robots;
  Backwards count;
  BadLines others(true);
  CsvReader again = reader.FromFirstRow(&others);
  while (again.Next()) {
    const std::optional<double> time_s = again.Number(time);
    if (!time_s) continue;
    ++count.rows;
    const std::string name(robot ? again.Text(*robot) : std::string_view());
    const auto [found, is_first] = robots.try_emplace(name, Last{*time_s, *time_s});
    if (is_first) continue;
    Last& last = found->second;
    if (*time_s < last.above_s) ++count.steps;
    if (*time_s < last.latest_s) ++count.before;
    last = {std::max(last.latest_s, *time_s), *time_s};
  }
  return count;
}

bool IsWholeSecond(double time_s) { return time_s == std::floor(time_s); }

// Of a row or two that are out of order sorting would make others of wrong times.
bool IsUnsorted(const Backwards& count) {
  constexpr std::size_t kLeastSteps = 2, kLeastShare = 10;  // one in so many rows
  return count.steps >= kLeastSteps && kLeastShare * count.before >= count.rows;
}

}  // namespace

std::string HintOfSameTime(double time_s, double last_s) {
  return time_s == last_s && IsWholeSecond(time_s) ? std::string("; ") + kWholeSeconds : "";
}

bool AreWholeSeconds(const Walked<double>& time_s) {
  return time_s.size() > 1 && std::ranges::all_of(time_s, IsWholeSecond);
}

bool AreWholeSeconds(const CsvReader& reader, std::size_t time) {
  BadLines others(true);
  CsvReader again = reader.FromFirstRow(&others);
  std::size_t rows = 0;
  while (again.Next()) {
    const std::optional<double> time_s = again.Number(time);
    if (time_s && !IsWholeSecond(*time_s)) return false;
    if (time_s) ++rows;
  }
  return rows > 1;
}

std::string DoubtRepeats(std::span<const double> time_s, std::span<const std::int32_t> landmark) {
  constexpr std::size_t kFewRows = 20, kLeastShare = 20;  // one in so many rows
  if (time_s.size() < kFewRows || !AreWholeSeconds(time_s)) return {};
  std::set<std::pair<double, std::int32_t>> seen;
  std::size_t repeats = 0;
  for (std::size_t i = 0; i < time_s.size(); ++i)
    if (landmark[i] >= 0 && !seen.emplace(time_s[i], landmark[i]).second) ++repeats;
  if (kLeastShare * repeats < time_s.size()) return {};
  return std::to_string(repeats) + " of " + std::to_string(time_s.size()) +
         " rows are of a landmark that another row is of at the same time, all times whole seconds: " +
         kWholeSeconds;
}

bool InTimeOrder(double time_s, double last_s, std::size_t time, std::optional<std::size_t> robot,
                 const std::string& hint, CsvReader* reader) {
  if (time_s >= last_s) return true;
  std::string detail = std::to_string(time_s) + " after " + std::to_string(last_s);
  if (!reader->skips()) {
    const Backwards count = CountBackwards(*reader, time, robot);
    if (IsUnsorted(count))
      detail += ", as in " + std::to_string(count.before) + " of " + std::to_string(count.rows) +
                " rows: " + kSortRows;
  }
  reader->Bad("time runs backwards", detail + hint);
  return false;
}

void TimeDigits::Add(double time_s) {
  ++rows_;
  if (times_ == 0) first_s_ = time_s;
  if (times_ == 0 || time_s != last_s_) ++times_;
  last_s_ = time_s;
  are_whole_ = are_whole_ && IsWholeSecond(time_s);
}

std::string TimeDigits::Count() const {
  return std::to_string(rows_) + " rows have " + std::to_string(times_) + (times_ == 1 ? " time" : " times");
}

std::string TimeDigits::Rounded() const {
  constexpr std::size_t kFewRows = 20, kRowsATime = 2;  // a row that turns and one that goes have one time
  if (!are_whole_ || rows_ < kFewRows || rows_ <= kRowsATime * times_) return {};
  return Count() + ", all whole seconds: " + kWholeSeconds;
}

std::string TimeDigits::Doubt() const {
  constexpr std::size_t kFewRows = 20, kRowsATime = 50;
  constexpr double kPause_s = 5;  // whole seconds are digits enough
  if (rows_ < kFewRows) return {};
  if (times_ > 1 && rows_ < kRowsATime * times_) return {};
  if (times_ > 1 && last_s_ - first_s_ < kPause_s * static_cast<double>(times_ - 1)) return {};
  return Count() + ": were they written with too few digits?";
}

}  // namespace cairn::datasets
