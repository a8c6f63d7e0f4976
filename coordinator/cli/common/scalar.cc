#include "coordinator/cli/common/scalar.h"

#include <charconv>
#include <cmath>

namespace cairn::cli {
namespace {

template <class T>
std::optional<T> Parse(const std::string& text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || text.empty()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> ToReal(const std::string& text) {
  const std::optional<double> value = Parse<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> ToInteger(const std::string& text) { return Parse<std::int64_t>(text); }

std::optional<std::uint64_t> ToUnsigned(const std::string& text) { return Parse<std::uint64_t>(text); }

std::string CheckSeed(const std::string& text) {
  if (ToUnsigned(text)) return "";
  return "'" + text + "' is no seed; allowed: a whole number from 0 to 18446744073709551615";
}

std::optional<bool> ToBoolean(const std::string& text) {
  if (text == "true") return true;
  if (text == "false") return false;
  return std::nullopt;
}

}  // namespace cairn::cli
