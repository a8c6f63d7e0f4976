#include "datasets/evaluate/scores.h"

#include <fmt/core.h>

#include <algorithm>
#include <concepts>
#include <nlohmann/json.hpp>
#include <numbers>

#include "schema/text.h"

namespace cairn::datasets {
namespace {

using Json = nlohmann::ordered_json;

// How people read values whose names end so.
struct Reading {
  const char* ending;
  const char* ending_for_people;
  const char* unit;
  double factor;
  int digits;
};

constexpr double kDegree = 180.0 / std::numbers::pi;

constexpr Reading kReadings[] = {
    {"_m", "_m", "m", 1, 3}, {"_rad", "_deg", "degrees", kDegree, 2}, {"_deg", "_deg", "degrees", 1, 2},
    {"_s", "_s", "s", 1, 3}, {"seconds", "seconds", "s", 1, 3},       {"", "", "", 1, 4},
};

const Reading& ReadingOf(const std::string& name) {
  return *std::ranges::find_if(kReadings, [&](const Reading& r) { return name.ends_with(r.ending); });
}

std::string NameForPeople(const std::string& name) {
  const Reading& reading = ReadingOf(name);
  return name.substr(0, name.size() - std::string(reading.ending).size()) + reading.ending_for_people;
}

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

Json JsonOf(const ScoreValue& value) {
  return std::visit(
      Overloaded{[](std::monostate) { return Json(nullptr); }, [](Share share) { return Json(share.value); },
                 [](const Interval& interval) { return Json({interval.low, interval.high}); },
                 [](const auto& plain) { return Json(plain); }},
      value);
}

// Nothing that rounds to zero has a sign.
std::string Rounded(double x, int digits) {
  std::string text = fmt::format("{:.{}f}", x, digits);
  if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string TextOf(const std::string& name, const ScoreValue& value, bool with_unit) {
  const Reading& reading = ReadingOf(name);
  const auto number = [&](double x) { return Rounded(x * reading.factor, reading.digits); };
  const std::string unit = with_unit && *reading.unit != 0 ? std::string(" ") + reading.unit : "";
  return std::visit(
      Overloaded{[](std::monostate) { return std::string("unknown"); },
                 [](bool yes) { return std::string(yes ? "yes" : "no"); },
                 [](std::integral auto count) { return std::to_string(count); },
                 [&](double x) { return number(x) + unit; },
                 [](Share share) { return Rounded(100 * share.value, 1) + "%"; },
                 [&](const Interval& i) { return "[" + number(i.low) + ", " + number(i.high) + "]" + unit; },
                 [](const std::string& text) { return text; },
                 [](const std::vector<std::string>& texts) {
                   std::string joined;
                   for (const std::string& text : texts) joined += (joined.empty() ? "" : ", ") + text;
                   return joined;
                 }},
      value);
}

// Words in place of a value that is not there.
std::string WithWords(const std::string& name, const ScoreValue& value, const std::string& words,
                      bool with_unit) {
  if (std::holds_alternative<std::monostate>(value) && !words.empty()) return words;
  return TextOf(name, value, with_unit) + words;
}

// In the unit that people read; none of what is no number.
std::optional<double> NumberOf(const std::string& name, const ScoreValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number * ReadingOf(name).factor;
  if (const auto* share = std::get_if<Share>(&value)) return 100 * share->value;
  if (const auto* count = std::get_if<std::int64_t>(&value)) return static_cast<double>(*count);
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*count);
  return std::nullopt;
}

std::string DifferenceOf(const std::string& name, const ScoreValue& a, const ScoreValue& b) {
  const auto from = NumberOf(name, a), to = NumberOf(name, b);
  if (!from || !to) return {};
  const int digits = std::holds_alternative<double>(a)  ? ReadingOf(name).digits
                     : std::holds_alternative<Share>(a) ? 1
                                                        : 0;
  const std::string text = Rounded(*to - *from, digits);
  return text.front() == '-' || *to == *from ? text : "+" + text;
}

}  // namespace

ScoreValue ShareOf(std::int64_t count, std::int64_t of) {
  if (of == 0) return {};
  return Share{static_cast<double>(count) / static_cast<double>(of)};
}

void Scores::Add(std::string name, ScoreValue value, std::string words) {
  entries_.push_back({std::move(name), std::move(value), std::move(words)});
}

void Scores::AddForPrograms(std::string name, ScoreValue value) {
  Add(std::move(name), std::move(value));
  entries_.back().for_people = false;
}

void Scores::AddForPeople(std::string name, std::string words) {
  Add(std::move(name), {}, std::move(words));
  entries_.back().for_programs = false;
}

void Scores::AddRows(std::string name, std::vector<Scores> rows) {
  Add(std::move(name), {});
  entries_.back().rows = std::move(rows);
}

void Scores::AddRowsForPrograms(std::string name, std::vector<Scores> rows) {
  AddRows(std::move(name), std::move(rows));
  entries_.back().for_people = false;
}

void Scores::AddGroup(const std::string& name, const Scores& scores) {
  for (Entry entry : scores.entries_) {
    entry.name = name + "." + entry.name;
    entries_.push_back(std::move(entry));
  }
}

std::string Scores::ToJson(int indent) const {
  const auto object = [](const auto& self, const Scores& scores) -> Json {
    Json json = Json::object();
    for (const Entry& entry : scores.entries_) {
      if (!entry.for_programs) continue;
      std::string path = "/" + entry.name;
      std::ranges::replace(path, '.', '/');
      Json& at = json[Json::json_pointer(path)];
      at = JsonOf(entry.value);
      if (!entry.rows) continue;
      at = Json::array();
      for (const Scores& row : *entry.rows) at.push_back(self(self, row));
    }
    return json;
  };
  return object(object, *this).dump(indent);
}

std::vector<std::pair<std::string, std::string>> Scores::Cells() const {
  std::vector<std::pair<std::string, std::string>> cells;
  for (const Entry& entry : entries_) {
    if (!entry.for_people) continue;
    cells.emplace_back(NameForPeople(entry.name), WithWords(entry.name, entry.value, entry.words, false));
  }
  return cells;
}

std::string Scores::Table(const std::vector<Scores>& rows) {
  std::vector<std::vector<std::string>> lines;
  for (const Scores& row : rows) {
    if (!row.for_people_) continue;
    if (lines.empty()) lines.emplace_back();
    lines.emplace_back();
    for (const auto& [name, text] : row.Cells()) {
      if (lines.size() == 2) lines.front().push_back(name);
      lines.back().push_back(text);
    }
  }
  std::vector<std::size_t> widths(lines.empty() ? 0 : lines.front().size());
  for (const auto& line : lines) {
    for (std::size_t k = 0; k < line.size(); ++k) widths[k] = std::max(widths[k], TextColumns(line[k]));
  }
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t k = 0; k < line.size(); ++k) text += "  " + Padded(line[k], widths[k]);
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text;
}

std::vector<std::array<std::string, 4>> Scores::Compared(const Scores& a, const Scores& b) {
  std::vector<std::array<std::string, 4>> rows;
  const auto is_read = [](const Entry& entry) { return entry.for_people && !entry.rows; };
  const auto text = [](const Entry& e) { return WithWords(e.name, e.value, e.words, true); };
  for (const Entry& of_a : a.entries_) {
    if (!is_read(of_a)) continue;
    const auto of_b = std::ranges::find_if(
        b.entries_, [&](const Entry& entry) { return is_read(entry) && entry.name == of_a.name; });
    const bool both = of_b != b.entries_.end();
    rows.push_back({NameForPeople(of_a.name), text(of_a), both ? text(*of_b) : "",
                    both ? DifferenceOf(of_a.name, of_a.value, of_b->value) : ""});
  }
  for (const Entry& of_b : b.entries_) {
    const auto same = [&](const Entry& entry) { return is_read(entry) && entry.name == of_b.name; };
    if (is_read(of_b) && std::ranges::none_of(a.entries_, same))
      rows.push_back({NameForPeople(of_b.name), "", text(of_b), ""});
  }
  return rows;
}

std::string Scores::ToText(std::size_t narrowest) const {
  std::size_t width = narrowest;
  for (const Entry& entry : entries_) {
    if (entry.for_people) width = std::max(width, NameForPeople(entry.name).size() + 1);
  }
  std::string text;
  for (const Entry& entry : entries_) {
    if (!entry.for_people) continue;
    if (entry.rows) {
      text += entry.name + "\n" + Table(*entry.rows);
    } else {
      text += Padded(NameForPeople(entry.name), width) +
              WithWords(entry.name, entry.value, entry.words, true) + "\n";
    }
  }
  return text;
}

}  // namespace cairn::datasets
