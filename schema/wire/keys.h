// CURVE key pairs. Keys are texts of 40 characters (Z85).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "schema/error.h"

namespace cairn::wire {

struct KeyPair {
  std::string public_key;
  std::string secret_key;

  ~KeyPair();  // overwrites the secret
};

KeyPair GenerateKeyPair();
bool IsPublicKey(std::string_view text);
// Of a public key, what logs show of it.
std::string ShortKey(const std::string& public_key);
// Writes `stem`.key (both keys, mode 0600) and `stem`.pub (the public one, to hand out). kBusy where one
// exists; on any failure no secret is left.
Status WriteKeyPair(const std::filesystem::path& stem, const KeyPair& keys);
// Reads a .key file. kRefused where it is another's, or others than its owner may read it. From then on this
// process leaves no core dump.
Result<KeyPair> ReadKeyPair(const std::filesystem::path& path);
// Reads the one key of a .pub file. kRefused where anybody can write to it, or put another in its place.
Result<std::string> ReadPublicKey(const std::filesystem::path& path);

}  // namespace cairn::wire
