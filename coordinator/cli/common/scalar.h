// Strict readers of single values, in full or not at all: no leading spaces, no trailing letters, no locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace cairn::cli {

std::optional<double> ToReal(const std::string& text);  // finite
std::optional<std::int64_t> ToInteger(const std::string& text);
std::optional<std::uint64_t> ToUnsigned(const std::string& text);
std::string CheckSeed(const std::string& text);          // empty where it is a seed, else what is allowed
std::optional<bool> ToBoolean(const std::string& text);  // true or false

}  // namespace cairn::cli
