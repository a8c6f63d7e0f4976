#include "coordinator/page/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "schema/text.h"

namespace cairn::page {
namespace {

// In a box of 16 by 16. The shape says it, not the colour.
const char* ShapeOf(const std::string& state) {
  if (state == "running" || state == "busy") return "<path d=\"M4 2l10 6-10 6z\"/>";
  if (state == "paused") return "<path d=\"M3 2h4v12H3zM9 2h4v12H9z\"/>";
  if (state == "done") return "<path class=\"stroke\" d=\"M2 9l4 4 8-10\"/>";
  if (state == "failed" || state == "hung") return "<path class=\"stroke\" d=\"M3 3l10 10M13 3L3 13\"/>";
  if (state == "cancelled")
    return "<circle class=\"stroke\" cx=\"8\" cy=\"8\" r=\"6\"/><path class=\"stroke\" d=\"M4 12l8-8\"/>";
  if (state == "draining") return "<path class=\"stroke\" d=\"M8 1v12M3 8l5 5 5-5\"/>";
  return "<circle class=\"stroke\" cx=\"8\" cy=\"8\" r=\"6\"/><path class=\"stroke\" d=\"M8 4v4l3 2\"/>";
}

}  // namespace

std::string Text(std::string_view text) {
  std::string html;
  for (const char c : Escaped(text)) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string UrlPart(std::string_view text) {
  std::string part;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '-' || c == '_' || c == '.')
      part += c;
    else
      part += fmt::format("%{:02X}", byte);
  }
  return part;
}

std::string Duration(double seconds) {
  const auto whole = static_cast<long long>(std::llround(std::max(0.0, seconds)));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string Count(std::uint64_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string Number(double value) {
  const double size = std::abs(value);
  if (size == 0 || (size >= 1e-4 && size < 1e7)) {
    const int digits = size == 0 ? 0 : std::max(0, 3 - static_cast<int>(std::floor(std::log10(size))));
    return fmt::format("{:.{}f}", value, std::min(digits, 7));
  }
  return fmt::format("{:.3g}", value);
}

std::string SaveButton(const std::string& kind, const std::string& what) {
  return fmt::format(
      "<p class=\"save scripted\"><button type=\"button\" data-save=\"{0}\" aria-label=\"Save {1} as "
      "{0}\">{0}</button></p>\n",
      kind, what);
}

std::string StateBadge(const std::string& state) {
  return fmt::format(
      "<span class=\"state {0}\"><svg viewBox=\"0 0 16 16\" width=\"12\" height=\"12\" "
      "aria-hidden=\"true\">{1}"
      "</svg>{0}</span>",
      Text(state), ShapeOf(state));
}

std::string ProgressBar(double part, const std::string& label) {
  if (part < 0) return "";
  return fmt::format("<progress max=\"1\" value=\"{:.3f}\" aria-label=\"{}\"></progress>",
                     std::clamp(part, 0.0, 1.0), Text(label));
}

}  // namespace cairn::page
