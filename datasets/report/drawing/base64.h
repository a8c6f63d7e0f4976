// Bytes inside a text: RFC 4648, section 4.
#pragma once

#include <string>
#include <string_view>

namespace cairn::datasets::report {

std::string Base64(std::string_view bytes);

}  // namespace cairn::datasets::report
