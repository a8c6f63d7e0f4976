#include "coordinator/store/printable.h"

#include <algorithm>

#include "schema/text.h"

namespace cairn::coordinator {
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

}  // namespace cairn::coordinator
