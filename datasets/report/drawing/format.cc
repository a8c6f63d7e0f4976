#include "datasets/report/drawing/format.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "schema/text.h"

namespace cairn::datasets::report {
namespace {

std::string Fixed(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

}  // namespace

std::string Short(double value, int digits) {
  std::string text = Fixed(value, digits);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string Grouped(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  std::string text = Fixed(std::abs(value), digits);
  const std::size_t point = text.find('.');
  for (std::size_t at = point == std::string::npos ? text.size() : point; at > 3; at -= 3)
    text.insert(at - 3, 1, ',');
  const bool negative = value < 0 && text.find_first_of("123456789") != std::string::npos;
  return negative ? "−" + text : text;
}

std::string Duration(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  if (seconds < 10) return Fixed(seconds, 2) + " s";
  if (seconds < 59.95) return Fixed(seconds, 1) + " s";
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string Count(std::int64_t count, const std::string& noun) {
  return Grouped(static_cast<double>(count)) + " " + noun + (count == 1 ? "" : "s");
}

std::string Escape(std::string_view text) {
  std::string escaped;
  for (const char c : cairn::Escaped(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace cairn::datasets::report
