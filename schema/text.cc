#include "schema/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "schema/blob.h"

namespace cairn {
namespace {

bool IsControl(char32_t code) {
  const bool turns = code == 0x061C || code == 0x200E || code == 0x200F ||
                     (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  return code < 0x20 || (code >= 0x7F && code <= 0x9F) || turns || code == 0x2028 || code == 0x2029;
}

bool IsLineOrTab(char32_t code) { return code == '\n' || code == '\r' || code == '\t'; }

std::string WhatIsWrong(std::string_view text, bool lines_may_be) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = Utf8Bytes(text, at);
    if (bytes == 0) return "is not UTF-8";
    const char32_t code = CodeAt(text, at, bytes);
    if (IsControl(code) && !(lines_may_be && IsLineOrTab(code))) return "has control characters";
    at += bytes;
  }
  return "";
}

// Behind the first NUL of a fixed-width text there is nothing but more of them.
std::string WhatIsWrongWithElement(std::string_view padded, bool alone, std::size_t most_bytes) {
  const std::string_view text = padded.substr(0, padded.find('\0'));
  if (padded.find_first_not_of('\0', text.size()) != std::string_view::npos) return "has control characters";
  return alone ? WhatIsWrongWithText(text) : WhatIsWrongWithName(text, most_bytes);
}

Status WrongName(const std::string& name, const std::string& wrong) {
  return {Code::kCorrupt,
          "the name of the dataset '" + EscapedName(name.substr(0, kMostNameBytes)) + "' " + wrong};
}

// HDF5 would silently drop parts that are empty and '.', and the name would not come back.
std::string WhatIsWrongWithDataset(const Blob& blob, const std::string& name) {
  if (name.find('\0') != std::string::npos) return "has control characters";
  if (std::count(name.begin(), name.end(), '/') >= kMostLevels)
    return "lies in groups within groups, more than " + std::to_string(kMostLevels) + " deep";
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    const std::string part = name.substr(at, end - at);
    if (part.empty() || part == ".") return "has a part that is empty or '.'";
    if (end < name.size() && blob.Has(std::string_view(name).substr(0, end)))
      return "lies in '" + name.substr(0, end) + "', which is a dataset";
    at = end + 1;
  }
  return "";
}

}  // namespace

std::size_t Utf8Bytes(std::string_view text, std::size_t at) {
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  if (first < 0x80) return 1;
  const std::size_t bytes = first >= 0xC2 && first <= 0xDF   ? 2
                            : first >= 0xE0 && first <= 0xEF ? 3
                            : first >= 0xF0 && first <= 0xF4 ? 4
                                                             : 0;
  if (bytes == 0 || at + bytes > text.size()) return 0;
  const unsigned char low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;   // no longer than needed
  const unsigned char high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;  // no surrogates, in range
  if (byte(at + 1) < low || byte(at + 1) > high) return 0;
  for (std::size_t i = at + 2; i < at + bytes; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  return bytes;
}

char32_t CodeAt(std::string_view text, std::size_t at, std::size_t bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (bytes == 1) return byte(at);
  char32_t code = byte(at) & (0xFFU >> (bytes + 1));
  for (std::size_t i = at + 1; i < at + bytes; ++i) code = code << 6 | (byte(i) & 0x3FU);
  return code;
}

std::string WhatIsWrongWithName(std::string_view name, std::size_t most_bytes) {
  if (name.size() > most_bytes) return "is longer than " + std::to_string(most_bytes) + " bytes";
  return WhatIsWrong(name, false);
}

std::string WhatIsWrongWithText(std::string_view text) { return WhatIsWrong(text, true); }

Status CheckForms(const Blob& blob) {
  for (const auto& [name, array] : blob.fields()) {
    if (const std::string wrong = WhatIsWrongWithDataset(blob, name); !wrong.empty())
      return WrongName(name, wrong);
    if (array.shape().size() > kMostDimensions)
      return {Code::kCorrupt,
              "dataset '" + name + "': of more than " + std::to_string(kMostDimensions) + " dimensions"};
  }
  return Status::Ok();
}

Status CheckTexts(const Blob& blob) {
  for (const auto& [name, array] : blob.fields()) {
    if (const std::string wrong = WhatIsWrongWithName(name, kMostDatasetBytes); !wrong.empty())
      return WrongName(name, wrong);
    if (array.type() != DType::kText) continue;
    const bool is_name = name == "robots" || name == "landmarks" || name == "runs";
    const std::size_t most = is_name ? kMostNameBytes : kMostTextBytes, width = array.item_bytes();
    const std::string_view bytes(reinterpret_cast<const char*>(array.bytes().data()), array.bytes().size());
    for (std::size_t at = 0; at < bytes.size(); at += width) {
      const std::string_view text = bytes.substr(at, width);
      const std::string wrong = WhatIsWrongWithElement(text, array.shape().empty(), most);
      if (wrong.empty()) continue;
      const std::string shown =
          EscapedName(text.substr(0, std::min(text.find_last_not_of('\0') + 1, kMostNameBytes)));
      return {Code::kCorrupt, "dataset '" + name + "': '" + shown + "' " + wrong};
    }
  }
  return CheckForms(blob);
}

std::string CutTo(std::string_view text, std::size_t most) {
  if (text.size() > most)
    while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;
  return std::string(text.substr(0, most));
}

std::string Escaped(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = Utf8Bytes(text, at);
    const char32_t code = bytes == 0 ? 0 : CodeAt(text, at, bytes);
    if (bytes == 0)
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[at]));
    else if (IsControl(code) && code != '\n' && code != '\t')
      shown += fmt::format("\\u{:04x}", static_cast<unsigned>(code));
    else
      shown.append(text, at, bytes);
    at += std::max<std::size_t>(bytes, 1);
  }
  return shown;
}

std::string EscapedName(std::string_view name) {
  std::string shown;
  for (const char c : Escaped(name))
    if (c == '\n' || c == '\t')
      shown += c == '\n' ? "\\n" : "\\t";
    else
      shown += c;
  return shown;
}

std::string Printable(const std::string& text, std::size_t most_bytes) {
  std::string safe;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = Utf8Bytes(text, at);
    if (at + std::max<std::size_t>(bytes, 1) > most_bytes) return safe + "…";
    const auto c = static_cast<unsigned char>(text[at]);
    if (bytes == 0)
      safe += '?';
    else if (bytes == 1)
      safe += c < 0x20 || c == 0x7f ? ' ' : text[at];
    else
      safe.append(text, at, bytes);
    at += std::max<std::size_t>(bytes, 1);
  }
  return safe;
}

std::size_t TextColumns(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;  // not the rest of a character
  }));
}

std::string Padded(std::string text, std::size_t columns) {
  const std::size_t has = TextColumns(text);
  return has < columns ? std::move(text) + std::string(columns - has, ' ') : text;
}

std::string ShellWord(const std::string& text) {
  const bool plain = std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 || c >= 0x80 ||
           std::string_view("/._-+,:=@%").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain && !text.empty()) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string NameList(const std::vector<std::string>& names, std::size_t most) {
  if (names.empty()) return "none";
  const std::size_t shown = std::min(names.size(), most);
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) text += (i == 0 ? "'" : ", '") + names[i] + "'";
  if (shown < names.size()) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

std::string BytesText(std::uint64_t bytes) {
  constexpr std::array kUnits = {"B", "kB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; value >= 1000 && unit + 1 < kUnits.size(); ++unit) value /= 1000;
  return fmt::format("{:.{}f} {}", value, unit == 0 ? 0 : 1, kUnits[unit]);
}

}  // namespace cairn
