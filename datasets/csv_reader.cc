#include "datasets/csv_reader.h"

#include <algorithm>

#include "schema/error.h"

namespace cairn::datasets {
namespace {

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

}  // namespace

CsvReader::CsvReader(const std::string& path, const std::vector<std::vector<std::string>>& headers,
                     BadLines* bad)
    : path_(path), text_(std::make_unique<const std::string>(ReadText(path))), lines_(*text_), bad_(bad) {
  if (!lines_.Next()) throw InputError(path + ": is empty; a header is needed: " + Join(headers[0]));
  if (!Split()) throw InputError(path + ":1: the header has an open quote");
  FindColumns(headers);
}

void CsvReader::FindColumns(const std::vector<std::vector<std::string>>& headers) {
  const auto has = [&](const std::string& column) { return std::ranges::count(fields_, column) > 0; };
  const auto fits =
      std::ranges::find_if(headers, [&](const auto& set) { return std::ranges::all_of(set, has); });
  if (fits == headers.end()) {
    std::string allowed;
    for (const auto& set : headers) allowed += (allowed.empty() ? "" : " or ") + Join(set);
    throw InputError(path_ + ":1: the header lacks columns: it must have " + allowed + ", it has " +
                     std::string(lines_.text()));
  }
  columns_ = *fits;
  header_ = static_cast<std::size_t>(fits - headers.begin());
  width_ = fields_.size();
  for (const std::string& column : columns_) {
    if (std::ranges::count(fields_, column) > 1)
      throw InputError(path_ + ":1: the header has " + column + " twice");
    places_.push_back(static_cast<std::size_t>(std::ranges::find(fields_, column) - fields_.begin()));
  }
  for (const std::string_view field : fields_) {
    if (std::ranges::find(columns_, field) == columns_.end()) extra_.emplace_back(field);
  }
}

void CsvReader::TakeExtraColumns() {
  for (const std::string& column : extra_) {
    if (column.empty()) throw InputError(path_ + ":1: the header has a column without a name");
    if (std::ranges::count(extra_, column) > 1)
      throw InputError(path_ + ":1: the header has " + column + " twice");
    places_.push_back(static_cast<std::size_t>(std::ranges::find(fields_, column) - fields_.begin()));
  }
  columns_.insert(columns_.end(), extra_.begin(), extra_.end());
}

bool CsvReader::Next() {
  while (lines_.Next()) {
    if (Trim(lines_.text()).empty()) continue;
    if (!Split()) {
      Bad("open quote");
    } else if (fields_.size() != width_) {
      Bad("wrong number of columns",
          std::to_string(fields_.size()) + " where the header has " + std::to_string(width_));
    } else {
      return true;
    }
  }
  return false;
}

// RFC 4180 but for line breaks within quotes.
bool CsvReader::Split() {
  fields_.clear();
  std::string_view rest = lines_.text();
  if (rest.find('"') == std::string_view::npos) {
    for (std::size_t comma = 0; (comma = rest.find(',')) != std::string_view::npos;
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
    } else if (rest[i] == ',' && !quoted) {
      unquoted_.emplace_back();
    } else {
      unquoted_.back() += rest[i];
    }
  }
  for (const std::string& field : unquoted_) fields_.push_back(Trim(field));
  return !quoted;
}

std::optional<double> CsvReader::Number(std::size_t index) {
  const char* reason = "";
  const std::optional<double> value = ParseNumber(Text(index), &reason);
  if (!value) Bad(reason, columns_[index] + " is '" + std::string(Text(index)) + "'");
  return value;
}

void CsvReader::Bad(const std::string& reason, const std::string& detail) {
  bad_->Add(path_, lines_.number(), reason, detail);
}

}  // namespace cairn::datasets
