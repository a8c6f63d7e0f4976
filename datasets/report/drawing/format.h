// Numbers and texts as people read them in a page.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace cairn::datasets::report {

// With at most `digits` decimals, trailing zeros cut off, "-0" avoided: "12.5". For coordinates in drawings.
std::string Short(double value, int digits = 2);

// With exactly `digits` decimals and thousands set apart: "1,006.5".
std::string Grouped(double value, int digits = 0);

// "0.42 s", "12.3 s", "4 min 05 s", "2 h 11 min".
std::string Duration(double seconds);

// "1 landmark", "20 landmarks".
std::string Count(std::int64_t count, const std::string& noun);

// For text and attribute values: & < > " '
std::string Escape(std::string_view text);

}  // namespace cairn::datasets::report
