// Takes a fuzzer's bytes apart: choices and values, in order; zeros once there are no more.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace cairn::fuzz {

class ByteSource {
 public:
  explicit ByteSource(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  std::uint8_t Byte() { return Take<std::uint8_t>(); }
  // In [0, n), n from 1 to 256.
  std::size_t Below(std::size_t n) { return Byte() % n; }
  template <class T>
  T Take() {
    T value{};
    const std::size_t size = std::min(sizeof(T), bytes_.size());
    if (size > 0) std::memcpy(&value, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
    return value;
  }
  // As long as a first byte says, and there is.
  std::string Text() {
    const auto bytes = Span(Byte());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::span<const std::uint8_t> Span(std::size_t size) {
    const auto taken = bytes_.first(std::min(size, bytes_.size()));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  std::span<const std::uint8_t> Rest() { return Span(bytes_.size()); }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace cairn::fuzz
