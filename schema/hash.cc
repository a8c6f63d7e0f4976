#include "schema/hash.h"

#include <xxhash.h>

#include <cstring>

namespace cairn {

std::string Hash::Hex() const {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : bytes) {
    hex += kDigits[byte >> 4];
    hex += kDigits[byte & 15];
  }
  return hex;
}

std::string Hash::Binary() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

Result<Hash> Hash::FromBinary(std::string_view binary) {
  Hash hash;
  if (binary.size() != hash.bytes.size())
    return Status(Code::kCorrupt, "a hash of another length than 16 bytes");
  std::memcpy(hash.bytes.data(), binary.data(), binary.size());
  return hash;
}

Result<Hash> Hash::FromHex(std::string_view hex) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  Hash hash;
  if (hex.size() != 2 * hash.bytes.size())
    return Status(Code::kCorrupt, "a hash of another length than 32 digits");
  for (std::size_t i = 0; i < hash.bytes.size(); ++i) {
    const int high = digit(hex[2 * i]);
    const int low = digit(hex[2 * i + 1]);
    if (high < 0 || low < 0)
      return Status(Code::kCorrupt, "a hash with a character that is no hexadecimal digit");
    hash.bytes[i] = static_cast<std::uint8_t>(high * 16 + low);
  }
  return hash;
}

struct Hasher::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

Hasher::Hasher() : state_(std::make_unique<State>()) { XXH3_128bits_reset(state_->xxh); }
Hasher::~Hasher() = default;

void Hasher::Add(std::span<const std::byte> bytes) {
  XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
}

void Hasher::Add(std::uint64_t value) {
  std::array<std::byte, 8> little;
  for (std::size_t i = 0; i < little.size(); ++i) little[i] = static_cast<std::byte>(value >> (8 * i));
  Add(little);
}

void Hasher::Add(std::string_view text) {
  Add(static_cast<std::uint64_t>(text.size()));
  Add(std::as_bytes(std::span(text)));
}

Hash Hasher::Finish() const {
  const XXH128_hash_t value = XXH3_128bits_digest(state_->xxh);
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, value);
  Hash hash;
  std::memcpy(hash.bytes.data(), canonical.digest, hash.bytes.size());
  return hash;
}

}  // namespace cairn
