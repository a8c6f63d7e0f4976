// XXH3-128 content hashes. They guard against accidents, not against forgery: keys are CURVE's.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "schema/error.h"

namespace cairn {

struct Hash {
  std::array<std::uint8_t, 16> bytes{};

  auto operator<=>(const Hash&) const = default;
  bool empty() const { return *this == Hash{}; }
  std::string Hex() const;     // 32 lower-case digits
  std::string Binary() const;  // 16 bytes, as protobuf fields hold them
  static Result<Hash> FromHex(std::string_view hex);
  static Result<Hash> FromBinary(std::string_view binary);
};

// A running hash over canonical bytes: integers little-endian, texts with their length before them.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;
  void Add(std::span<const std::byte> bytes);
  void Add(std::uint64_t value);
  void Add(std::string_view text);
  Hash Finish() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cairn
