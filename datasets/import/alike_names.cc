#include "datasets/import/alike_names.h"

#include <cctype>
#include <set>
#include <unordered_map>

namespace cairn::datasets {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// In small letters, without zeros that lead a whole number: those behind a decimal point count.
std::string Plain(const std::string& name) {
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
         ": their names differ in case or leading zeros alone";
}

}  // namespace cairn::datasets
