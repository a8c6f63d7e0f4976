#include "datasets/import/name_index.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>

namespace cairn::datasets {
namespace {

bool IsNumber(const std::string& name) {
  return !name.empty() && std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; });
}

bool ComesBefore(const std::string& a, const std::string& b) {
  const bool a_is_number = IsNumber(a), b_is_number = IsNumber(b);
  if (a_is_number != b_is_number) return a_is_number;
  if (!a_is_number) return a < b;
  const auto digits = [](const std::string& name) {
    return name.substr(std::min(name.find_first_not_of('0'), name.size()));
  };
  const std::string a_digits = digits(a), b_digits = digits(b);
  if (a_digits.size() != b_digits.size()) return a_digits.size() < b_digits.size();
  return a_digits != b_digits ? a_digits < b_digits : a < b;
}

// Beyond ASCII everything counts as a letter.
bool IsLetterOrDigit(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || (c & 0x80) != 0; }

}  // namespace

bool MeansUnknown(std::string_view name) {
  constexpr std::array kWords = {"-1", "unknown", "none", "nan", "null", "na", "n/a"};
  std::string small(name);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool says_nothing = !name.empty() && std::ranges::none_of(name, IsLetterOrDigit);
  return says_nothing || std::ranges::find(kWords, small) != kWords.end();
}

std::int32_t NameIndex::Find(std::string_view name) const {
  const auto it = numbers_.find(name);
  return it == numbers_.end() ? -1 : it->second;
}

std::int32_t NameIndex::FindOrAdd(std::string_view name) {
  const std::int32_t found = Find(name);
  if (found >= 0) return found;
  const auto number = static_cast<std::int32_t>(names_.size());
  names_.emplace_back(name);
  numbers_.emplace(name, number);
  return number;
}

std::vector<std::int32_t> NameIndex::Sort() {
  const std::vector<std::string> before = names_;
  std::ranges::sort(names_, ComesBefore);
  for (std::size_t i = 0; i < names_.size(); ++i) numbers_[names_[i]] = static_cast<std::int32_t>(i);
  std::vector<std::int32_t> renumbered;
  renumbered.reserve(before.size());
  for (const std::string& name : before) renumbered.push_back(Find(name));
  return renumbered;
}

}  // namespace cairn::datasets
