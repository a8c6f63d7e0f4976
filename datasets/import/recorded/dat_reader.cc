#include "datasets/import/recorded/dat_reader.h"

#include <algorithm>
#include <optional>

namespace cairn::datasets {

DatReader::DatReader(const std::string& path, std::size_t columns, BadLines* bad)
    : path_(path), text_(ReadText(path)), lines_(text_), columns_(columns), bad_(bad) {}

bool DatReader::Next() {
  while (lines_.Next()) {
    const std::string_view line = Trim(lines_.text());
    if (!line.empty() && line[0] != '#' && Parse()) return true;
  }
  return false;
}

bool DatReader::Parse() {
  numbers_.clear();
  std::string_view rest = Trim(lines_.text());
  while (!rest.empty()) {
    const std::string_view field = rest.substr(0, rest.find_first_of(" \t"));
    const char* reason = "";
    const std::optional<double> number = ParseNumber(field, &reason);
    if (!number) {
      Bad(reason, "column " + std::to_string(numbers_.size() + 1) + " is '" + std::string(field) + "'");
      return false;
    }
    numbers_.push_back(*number);
    rest = Trim(rest.substr(field.size()));
  }
  if (numbers_.size() == columns_) return true;
  Bad("wrong number of columns",
      std::to_string(numbers_.size()) + " where " + std::to_string(columns_) + " are needed");
  return false;
}

void DatReader::Bad(const std::string& reason, const std::string& detail) {
  bad_->Add(path_, lines_.number(), reason, detail);
}

bool DatReader::InOrder() {
  if (begun_ && numbers_[0] < last_time_) {
    Bad("time runs backwards", std::to_string(numbers_[0]) + " after " + std::to_string(last_time_));
    return false;
  }
  begun_ = true;
  last_time_ = numbers_[0];
  return true;
}

}  // namespace cairn::datasets
