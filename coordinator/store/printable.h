// What others wrote, made fit for a log, a terminal and a message.
#pragma once

#include <cstddef>
#include <string>

namespace cairn::coordinator {

// No control characters, nothing but whole characters of UTF-8 (else '?'), at most `most_bytes` and a '…'.
std::string Printable(const std::string& text, std::size_t most_bytes);

}  // namespace cairn::coordinator
