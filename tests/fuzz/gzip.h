#pragma once

#include <string>
#include <string_view>

namespace cairn::fuzz {

std::string Gzip(std::string_view text);

}  // namespace cairn::fuzz
