#include "datasets/import/alike_names.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <unordered_map>

namespace cairn::datasets {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// A name that is a number with decimals, without the zeros that end them: a column that some program took for
// numbers is written so as soon as a row of it is empty.
std::string WithoutEmptyDecimals(const std::string& name) {
  const std::size_t point = name.find('.');
  const bool is_number =
      point != std::string::npos && point > 0 &&
      std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(point), IsDigit) &&
      std::all_of(name.begin() + static_cast<std::ptrdiff_t>(point) + 1, name.end(), IsDigit);
  if (!is_number) return name;
  const std::size_t last = name.find_last_not_of('0');
  return name.substr(0, last == point ? point : last + 1);
}

// In small letters, without zeros that lead a whole number: those behind a decimal point count.
std::string Plain(const std::string& given) {
  const std::string name = WithoutEmptyDecimals(given);
  std::string plain;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool begins = i == 0 || !IsDigit(name[i - 1]), ends = i + 1 == name.size() || !IsDigit(name[i + 1]);
    const bool decimals = begins && i >= 2 && name[i - 1] == '.' && IsDigit(name[i - 2]);
    if (name[i] == '0' && begins && !ends && !decimals) {
      while (i + 1 < name.size() && name[i] == '0' && IsDigit(name[i + 1])) ++i;
    }
    plain += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
  }
  return plain;
}

}  // namespace

std::string WarningOfAlikeNames(const std::vector<std::string>& names, const std::string& kind) {
  std::unordered_map<std::string, std::string> first_of;
  std::set<std::string> others;  // than the first of their kind
  std::string pair;
  for (const std::string& name : names) {
    const std::string& first = first_of.try_emplace(Plain(name), name).first->second;
    if (first == name || !others.insert(name).second) continue;
    if (pair.empty()) pair = "'" + first + "' and '" + name + "'";
  }
  if (others.empty()) return {};
  return pair + " are taken for two " + kind +
         (others.size() == 1 ? "" : ", and so are " + std::to_string(others.size() - 1) + " more pairs") +
         ": their names differ in case or zeros alone";
}

}  // namespace cairn::datasets
