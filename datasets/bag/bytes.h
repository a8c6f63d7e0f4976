// Bytes of a container, walked over within their bounds; little-endian, as all containers are.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace cairn::datasets::bag {

static_assert(std::endian::native == std::endian::little);

using ByteSpan = std::span<const std::byte>;

// Something in a bag is not as its format says: thrown where it is found, caught where it is known whose it
// is.
struct Damage {
  std::string what;
};

inline std::string_view AsText(ByteSpan bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Throws Damage "cut short: WHAT" beyond the end.
class ByteReader {
 public:
  ByteReader(ByteSpan bytes, const char* what) : bytes_(bytes), what_(what) {}
  std::size_t left() const { return bytes_.size(); }
  ByteSpan Bytes(std::uint64_t count) {
    if (count > bytes_.size()) throw Damage{std::string("cut short: ") + what_};
    const ByteSpan taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  template <class T>
  T Take() {
    T value;
    std::memcpy(&value, Bytes(sizeof value).data(), sizeof value);
    return value;
  }
  // After its length in four bytes.
  ByteSpan Block() { return Bytes(Take<std::uint32_t>()); }
  std::string Text() { return std::string(AsText(Block())); }

 private:
  ByteSpan bytes_;
  const char* what_;
};

}  // namespace cairn::datasets::bag
