#include "coordinator/printable.h"

#include <algorithm>

namespace cairn::coordinator {
namespace {

// Bytes of the character of UTF-8 that begins at `at`; 0 where none does (RFC 3629, section 4).
std::size_t CharacterBytes(const std::string& text, std::size_t at) {
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

}  // namespace

std::string Printable(const std::string& text, std::size_t most_bytes) {
  std::string safe;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = CharacterBytes(text, at);
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

}  // namespace cairn::coordinator
