#include "schema/name_list.h"

#include <algorithm>

namespace cairn {

std::string NameList(const std::vector<std::string>& names, std::size_t most) {
  if (names.empty()) return "none";
  const std::size_t shown = std::min(names.size(), most);
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) text += (i == 0 ? "'" : ", '") + names[i] + "'";
  if (shown < names.size()) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

}  // namespace cairn
