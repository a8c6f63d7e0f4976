#include "datasets/common/fields.h"

#include <cmath>
#include <optional>

namespace cairn::datasets {
namespace {

std::string FieldName(std::size_t field) { return "field " + std::to_string(field + 1); }

}  // namespace

LineError UnknownMessage(std::string_view name) {
  constexpr std::size_t kShown = 40;
  return {"unknown message", "'" + std::string(name.substr(0, kShown)) + "'"};
}

Fields::Fields(std::string_view line, bool by_commas) {
  for (std::string_view rest = line; by_commas;) {
    const std::size_t comma = rest.find(',');
    fields_.push_back(Trim(rest.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    rest.remove_prefix(comma + 1);
  }
  constexpr std::string_view kBlanks = " \t";
  for (std::string_view rest = Trim(line); !rest.empty(); rest = Trim(rest)) {
    fields_.push_back(rest.substr(0, rest.find_first_of(kBlanks)));
    rest.remove_prefix(fields_.back().size());
  }
}

std::string_view Fields::Text(std::size_t field) const {
  if (field >= fields_.size())
    throw LineError{"line cut short", "it has " + std::to_string(fields_.size()) + " fields"};
  return fields_[field];
}

double Fields::Number(std::size_t field) const {
  const char* reason = "";
  const std::optional<double> number = ParseNumber(Text(field), &reason);
  if (!number) throw LineError{reason, FieldName(field) + " is '" + std::string(Text(field)) + "'"};
  return *number;
}

double Fields::Within(std::size_t field, double per, double most, const char* otherwise) const {
  const double number = Number(field) / per;
  if (std::abs(number) <= most) return number;
  throw LineError{otherwise, FieldName(field) + " is '" + std::string(Text(field)) + "'"};
}

double Fields::Place(std::size_t field, double per_m) const {
  constexpr double kMost_m = 1e7;
  return Within(field, per_m, kMost_m, "no place on Earth");
}

Pose Fields::PoseAt(std::size_t first, double per_m) const {
  constexpr double kMost_rad = 1e6;
  return {Place(first, per_m), Place(first + 1, per_m), Within(first + 2, 1, kMost_rad, "no heading")};
}

double Fields::Stamp(std::size_t field, double per_s) const {
  constexpr double kMost_s = 4.2e9;
  return Within(field, per_s, kMost_s, "no time stamp");
}

std::size_t Fields::Count(std::size_t field, std::size_t most) const {
  const double number = Number(field);
  if (!(number >= 0 && number <= static_cast<double>(most)) ||
      number != static_cast<double>(static_cast<std::size_t>(number)))
    throw LineError{"no count", FieldName(field) + " is '" + std::string(Text(field)) + "'; allowed: 0 to " +
                                    std::to_string(most)};
  return static_cast<std::size_t>(number);
}

std::vector<double> Fields::Ranges(std::size_t first, std::size_t count, double most_m) const {
  std::vector<double> ranges;
  ranges.reserve(count);
  for (std::size_t beam = 0; beam < count; ++beam) {
    const std::string what = "beam " + std::to_string(beam) + " measures " + std::string(Text(first + beam));
    const char* reason = "";
    const std::optional<double> range_m = ParseNumber(Text(first + beam), &reason);
    if (!range_m) throw LineError{std::string("range is ") + reason, what};
    ranges.push_back(*range_m);
    if (ranges.back() < 0) throw LineError{"negative range", what};
    if (ranges.back() > most_m) throw LineError{"beyond any sensor's reach", what};
  }
  return ranges;
}

void Fields::Need(std::size_t needed, const std::string& declared) const {
  if (size() == needed) return;
  throw LineError{
      size() < needed ? "line cut short, or fewer values than it declares"
                      : "more values than the line declares",
      declared + " take " + std::to_string(needed) + " fields, there are " + std::to_string(size())};
}

void ForEachLine(const std::string& path, BadLines* bad,
                 const std::function<void(const Fields&, std::size_t)>& read, bool by_commas) {
  const std::string text = ReadText(path);
  for (Lines lines(text); lines.Next();) {
    if (Trim(lines.text()).empty()) continue;
    const Fields fields(lines.text(), by_commas);
    if (fields.Text(0).starts_with('#')) continue;
    try {
      read(fields, lines.number());
    } catch (const LineError& error) {
      bad->Add(path, lines.number(), error.reason, error.detail);
    }
  }
}

}  // namespace cairn::datasets
