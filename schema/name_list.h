// Names in a message: some of them, for a log may have thousands.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace cairn {

inline constexpr std::size_t kMostNamesShown = 5;

// "'ann', 'bob' and 3 more"; "none" where there are none.
std::string NameList(const std::vector<std::string>& names, std::size_t most = kMostNamesShown);

}  // namespace cairn
