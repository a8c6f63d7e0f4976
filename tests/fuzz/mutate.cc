#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace cairn::fuzz {
namespace {

constexpr std::array<std::string_view, 20> kWords{",",
                                                  "\n",
                                                  "\r\n",
                                                  "\"",
                                                  "nan",
                                                  "-inf",
                                                  "1e999",
                                                  "-1",
                                                  "1e-999",
                                                  "+",
                                                  "0x1",
                                                  ",,,",
                                                  "\xFF",
                                                  "a",
                                                  "b",
                                                  " ",
                                                  "door",
                                                  "18446744073709551616",
                                                  "\xEF\xBB\xBF",
                                                  "\x1f\x8b\x08"};

std::ptrdiff_t Place(const Bytes& bytes, Rng* rng) {
  return static_cast<std::ptrdiff_t>(rng->Below(bytes.size() + 1));
}

// A piece of at most 32 bytes.
Bytes Piece(const Bytes& bytes, Rng* rng) {
  const std::ptrdiff_t begin = Place(bytes, rng);
  const auto length = static_cast<std::ptrdiff_t>(rng->Below(33));
  const std::ptrdiff_t end = std::min(begin + length, static_cast<std::ptrdiff_t>(bytes.size()));
  return {bytes.begin() + begin, bytes.begin() + end};
}

void Change(Bytes* bytes, Rng* rng) {
  const auto at = bytes->begin() + Place(*bytes, rng);
  switch (rng->Below(6)) {
    case 0:
      if (at != bytes->end()) *at ^= static_cast<std::uint8_t>(1U << rng->Below(8));
      break;
    case 1:
      if (at != bytes->end()) *at = static_cast<std::uint8_t>(rng->Bits32());
      break;
    case 2: {
      const std::string_view word = kWords[rng->Below(kWords.size())];
      bytes->insert(at, word.begin(), word.end());
      break;
    }
    case 3:
      bytes->erase(
          at, at + std::min<std::ptrdiff_t>(bytes->end() - at, static_cast<std::ptrdiff_t>(rng->Below(17))));
      break;
    case 4: {
      const Bytes piece = Piece(*bytes, rng);
      bytes->insert(bytes->begin() + Place(*bytes, rng), piece.begin(), piece.end());
      break;
    }
    default:
      if (rng->Below(8) == 0) bytes->erase(at, bytes->end());
  }
}

}  // namespace

Bytes Mutate(Bytes bytes, Rng* rng) {
  for (std::uint64_t changes = 1 + rng->Below(8); changes > 0; --changes) Change(&bytes, rng);
  return bytes;
}

}  // namespace cairn::fuzz
