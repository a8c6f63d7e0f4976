#include "datasets/import/csv_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets {

std::string InSmallLetters(std::string_view text) {
  std::string small(text);
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return std::tolower(c); });
  return small;
}

namespace {

// A column may be left out that ends in it.
constexpr char kOptional = '?';

std::string Bare(const std::string& column) {
  return column.ends_with(kOptional) ? column.substr(0, column.size() - 1) : column;
}

std::string Join(const std::vector<std::string>& columns) {
  std::string text;
  for (const std::string& column : columns) {
    const std::string comma = text.empty() ? "" : ",";
    text += column.ends_with(kOptional) ? "[" + comma + Bare(column) + "]" : comma + column;
  }
  return text;
}

// An ending of a column's name, another that it may have instead, and how many of that make one of this.
struct OtherUnit {
  std::string_view unit, other;
  double per;
};

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
constexpr std::array kOtherUnits = {
    OtherUnit{"_m", "_mm", 1e3},
    OtherUnit{"_m", "_cm", 1e2},
    OtherUnit{"_s", "_ms", 1e3},
    OtherUnit{"_s", "_us", 1e6},
    OtherUnit{"_s", "_ns", 1e9},
    OtherUnit{"_rad", "_deg", kDegreesPerRadian},
    OtherUnit{"_mps", "_mmps", 1e3},
    OtherUnit{"_mps", "_cmps", 1e2},
    OtherUnit{"_radps", "_degps", kDegreesPerRadian},
};

// A column as a file may call it.
struct Spelling {
  std::string name;
  double per = 1;
};

std::vector<Spelling> SpellingsOf(const std::string& column) {
  std::vector<Spelling> spellings = {{Bare(column)}};
  for (const OtherUnit& unit : kOtherUnits) {
    std::string name = Bare(column);
    if (!name.ends_with(unit.unit)) continue;
    name.replace(name.size() - unit.unit.size(), unit.unit.size(), unit.other);
    spellings.push_back({name, unit.per});
  }
  return spellings;
}

// Whether a column holds numbers, by the unit at the end of its name.
bool HasUnit(std::string_view column) {
  const std::string name = InSmallLetters(column);
  return std::ranges::any_of(kOtherUnits, [&](const OtherUnit& unit) {
    return name.ends_with(unit.unit) || name.ends_with(unit.other);
  });
}

// "# time_s,robot" without its mark.
std::string_view WithoutMark(std::string_view comment) {
  comment = Trim(comment);
  while (comment.starts_with('#')) comment.remove_prefix(1);
  return comment;
}

// What stands between the fields of a header.
char SeparatorOf(std::string_view header) {
  for (const char separator : {',', ';', '\t'})
    if (header.find(separator) != std::string_view::npos) return separator;
  return ',';
}

// "sep=;", by which spreadsheets tell each other what the header shows anyway.
bool IsSeparatorLine(std::string_view line) { return Trim(line).size() == 5 && line.starts_with("sep="); }

}  // namespace

CsvReader::CsvReader(const std::string& path, const std::vector<std::vector<std::string>>& headers,
                     BadLines* bad)
    : path_(path),
      text_(std::make_shared<const std::string>(ReadText(path))),
      lines_(*text_),
      rows_(*text_),
      bad_(bad) {
  if (text_->starts_with("\xFF\xFE") || text_->starts_with("\xFE\xFF"))
    throw InputError(path + ": is UTF-16; save it as UTF-8 (or as plain CSV)");
  FindHeader(headers);
  rows_ = lines_;
}

void CsvReader::FindHeader(const std::vector<std::vector<std::string>>& headers) {
  std::optional<Lines> comment;  // the last one
  bool is_there = false;
  while (!is_there && lines_.Next()) {
    if (lines_.text().find('\r') != std::string_view::npos)
      throw InputError(path_ +
                       ": its lines end in a carriage return alone; save it with ends of lines of today");
    const std::string_view line = Trim(lines_.text());
    if (lines_.number() == 1 && IsSeparatorLine(line)) continue;
    if (line.starts_with('#')) comment = lines_;
    is_there = !line.empty() && !line.starts_with('#');
  }
  const auto fits = [&](std::string_view line) {
    separator_ = SeparatorOf(line);
    return Split(line) && Fitting(headers) != nullptr;
  };
  if (is_there && fits(lines_.text())) return FindColumns(headers, lines_.text());
  if (comment && fits(WithoutMark(comment->text()))) {
    lines_ = *comment;
    return FindColumns(headers, WithoutMark(lines_.text()));
  }
  if (!is_there) throw InputError(path_ + ": is empty; a header is needed: " + Join(headers[0]));
  separator_ = SeparatorOf(lines_.text());
  if (!Split(lines_.text())) throw InputError(Place() + "the header has an open quote");
  FindColumns(headers, lines_.text());
}

CsvReader CsvReader::FromFirstRow(BadLines* bad) const {
  CsvReader again = *this;
  again.lines_ = rows_;
  again.bad_ = bad;
  again.fields_.clear();  // they look into this one's
  return again;
}

std::string CsvReader::Place() const { return path_ + ":" + std::to_string(lines_.number()) + ": "; }

std::map<std::string_view, std::size_t> PlacesOf(const std::vector<std::string>& names) {
  std::map<std::string_view, std::size_t> places;
  for (std::size_t k = 0; k < names.size(); ++k) places.emplace(names[k], k);
  return places;
}

std::vector<std::size_t> CsvReader::Standing(const std::string& name) const {
  std::vector<std::size_t> exact, in_other_letters;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    if (fields_[k] == name) exact.push_back(k);
    if (InSmallLetters(fields_[k]) == name) in_other_letters.push_back(k);
  }
  return exact.empty() ? in_other_letters : exact;
}

const std::vector<std::string>* CsvReader::Fitting(
    const std::vector<std::vector<std::string>>& headers) const {
  const auto may = [&](const std::string& column) {
    const auto stands = [&](const Spelling& spelling) { return !Standing(spelling.name).empty(); };
    return column.ends_with(kOptional) || std::ranges::any_of(SpellingsOf(column), stands);
  };
  const auto fits =
      std::ranges::find_if(headers, [&](const auto& set) { return std::ranges::all_of(set, may); });
  return fits == headers.end() ? nullptr : &*fits;
}

// Beside seconds they are the whole time again or, as in ROS, what goes beyond whole seconds; taken for the
// other either is wrong.
void CsvReader::CheckForNanoseconds(const std::string& column) const {
  constexpr std::string_view kSeconds = "_s", kNanoseconds = "_ns";
  if (!column.ends_with(kSeconds)) return;
  std::string other = column;
  other.replace(other.size() - kSeconds.size(), kSeconds.size(), kNanoseconds);
  if (Standing(other).empty()) return;
  throw InputError(Place() + "the header has both " + column + " and " + other +
                   ", and does not say whether " + other +
                   " is the whole time or what goes beyond whole seconds: leave one of them out (" + column +
                   " may have decimals)");
}

void CsvReader::FindColumns(const std::vector<std::vector<std::string>>& headers, std::string_view line) {
  const std::vector<std::string>* fits = Fitting(headers);
  if (fits == nullptr) {
    std::string allowed;
    for (const auto& set : headers) allowed += (allowed.empty() ? "" : " or ") + Join(set);
    throw InputError(Place() + "the header lacks columns: it must have " + allowed + ", it has " +
                     Excerpt(line));
  }
  header_ = static_cast<std::size_t>(fits - headers.data());
  width_ = fields_.size();
  begins_with_names_ = !HasUnit(fields_.front());
  std::vector<std::uint8_t> is_wanted(width_);
  for (const std::string& wanted : *fits) {
    Spelling column{Bare(wanted)};
    std::vector<std::size_t> places;
    for (const Spelling& spelling : SpellingsOf(wanted)) {
      places = Standing(spelling.name);
      if (places.empty()) continue;
      column = spelling;
      break;
    }
    if (places.size() > 1) throw InputError(Place() + "the header has " + column.name + " twice");
    CheckForNanoseconds(column.name);
    places_.push_back(places.empty() ? kMissing : places[0]);
    columns_.push_back(column.name);
    per_unit_.push_back(column.per);
    if (!places.empty()) is_wanted[places[0]] = 1;
  }
  for (std::size_t k = 0; k < width_; ++k)
    if (!is_wanted[k]) extra_.emplace_back(fields_[k]);
}

void CsvReader::TakeExtraColumns() {
  std::map<std::string_view, std::size_t> places;
  for (std::size_t k = 0; k < fields_.size(); ++k) places.emplace(fields_[k], k);
  const std::map<std::string_view, std::size_t> once = PlacesOf(extra_);
  for (std::size_t k = 0; k < extra_.size(); ++k) {
    const std::string& column = extra_[k];
    if (column.empty()) throw InputError(Place() + "the header has a column without a name");
    if (once.at(column) != k) throw InputError(Place() + "the header has " + column + " twice");
    places_.push_back(places.at(column));
    per_unit_.push_back(1);
  }
  columns_.insert(columns_.end(), extra_.begin(), extra_.end());
}

bool CsvReader::Next() {
  while (lines_.Next()) {
    if (Trim(lines_.text()).empty()) continue;
    const bool closed = Split(lines_.text());
    if (IsComment()) continue;
    if (!closed) {
      Bad("open quote", "a line break within quotes is not read");
    } else if (fields_.size() != width_) {
      Bad("wrong number of columns",
          std::to_string(fields_.size()) + " where the header has " + std::to_string(width_));
    } else {
      return true;
    }
  }
  return false;
}

bool CsvReader::IsComment() const {
  return Trim(lines_.text()).starts_with('#') && !(begins_with_names_ && fields_.size() == width_);
}

// RFC 4180 but for line breaks within quotes.
bool CsvReader::Split(std::string_view line) {
  fields_.clear();
  std::string_view rest = line;
  if (rest.find('"') == std::string_view::npos) {
    for (std::size_t comma = 0; (comma = rest.find(separator_)) != std::string_view::npos;
         rest.remove_prefix(comma + 1)) {
      fields_.push_back(Trim(rest.substr(0, comma)));
    }
    fields_.push_back(Trim(rest));
    return true;
  }
  unquoted_.assign(1, "");
  bool quoted = false;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i] == '"' && quoted && i + 1 < rest.size() && rest[i + 1] == '"') {
      unquoted_.back() += rest[i++];
    } else if (rest[i] == '"') {
      quoted = !quoted;
    } else if (rest[i] == separator_ && !quoted) {
      unquoted_.emplace_back();
    } else {
      unquoted_.back() += rest[i];
    }
  }
  for (const std::string& field : unquoted_) fields_.push_back(Trim(field));
  return !quoted;
}

std::optional<std::string_view> CsvReader::Name(std::size_t index) {
  const std::string wrong = WhatIsWrongWithName(Text(index));
  if (wrong.empty()) return Text(index);
  constexpr std::size_t kShown = 40;
  Bad("a name that " + wrong, columns_[index] + " is '" + Printable(std::string(Text(index)), kShown) + "'");
  return std::nullopt;
}

std::optional<double> CsvReader::Number(std::size_t index) {
  std::string_view text = Text(index);
  std::string with_point;
  const std::size_t mark = separator_ == ',' ? std::string_view::npos : text.find_first_of(".,");
  if (mark != std::string_view::npos) {
    const char decimal = text[mark];
    if (decimal_ == 0) decimal_ = decimal;
    if (decimal != decimal_) {
      Bad("decimal commas and points in one file", columns_[index] + " is '" + std::string(text) + "'");
      return std::nullopt;
    }
    with_point = text;
    with_point[mark] = '.';
    text = with_point;
  }
  const char* reason = "";
  const std::optional<double> value = ParseNumber(text, &reason);
  if (!value) {
    const bool date = columns_[index].starts_with("time_") && text.find_first_of(":/") != text.npos;
    Bad(reason, columns_[index] + " is '" + std::string(Text(index)) + "'" +
                    (date ? "; times are seconds of any clock, such as Unix time, no dates" : ""));
    return std::nullopt;
  }
  const double in_unit = *value / per_unit_[index];
  constexpr double kMostTime_s = 1e19, kMost = 1e9;  // in metres, radians, and these a second
  const std::string& column = columns_[index];
  const auto ends = [&column](const char* unit) { return column.ends_with(unit); };
  const bool is_motion = ends("_m") || ends("_rad") || ends("_mps") || ends("_radps");
  if ((column.starts_with("time_") && std::abs(in_unit) > kMostTime_s) ||
      (is_motion && std::abs(in_unit) > kMost)) {
    Bad("a number that no robot comes to", columns_[index] + " is '" + std::string(Text(index)) + "'");
    return std::nullopt;
  }
  return in_unit;
}

void CsvReader::Bad(const std::string& reason, const std::string& detail) {
  bad_->Add(path_, lines_.number(), reason, detail);
}

}  // namespace cairn::datasets
