#include "datasets/common/landmark_labels.h"

#include <algorithm>
#include <string_view>

namespace cairn::datasets {
namespace {

// Whether `name` is `prefix` and a number.
bool IsNumbered(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix) || name.size() == prefix.size()) return false;
  return std::ranges::all_of(name.substr(prefix.size()), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::vector<std::string> LandmarkLabels(const kinds::LandmarkMap::Map& map,
                                        const std::vector<std::string>& names) {
  std::string prefix = "#";
  while (std::ranges::any_of(names, [&](const std::string& name) { return IsNumbered(name, prefix); }))
    prefix += '#';
  const std::span<const std::int32_t> identity = map.landmark_identity.OrNone();
  std::vector<std::string> labels;
  for (std::size_t k = 0; k < map.landmark_x_m.OrNone().size(); ++k) {
    const std::int32_t name = identity.empty() ? -1 : identity[k];
    labels.push_back(name < 0 ? prefix + std::to_string(k) : names.at(static_cast<std::size_t>(name)));
  }
  return labels;
}

}  // namespace cairn::datasets
