// A text in the letters that OpenCV draws.
#pragma once

#include <string>
#include <string_view>

namespace cairn::datasets::report {

// Latin letters with marks by their base letters ("Säule" is "Saule", "ß" is "ss"), dashes as '-', marks that
// stand for themselves left out; any other character beyond ASCII is one '?'.
std::string Ascii(std::string_view text);

}  // namespace cairn::datasets::report
