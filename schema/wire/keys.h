// CURVE key pairs and the list of clients that may connect. Keys are texts of 40 characters (Z85).
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "schema/error.h"

namespace cairn::wire {

struct KeyPair {
  std::string public_key;
  std::string secret_key;
};

KeyPair GenerateKeyPair();
// Writes `stem`.key (both keys, mode 0600) and `stem`.pub (the public one, to hand out). kBusy where one
// exists.
Status WriteKeyPair(const std::filesystem::path& stem, const KeyPair& keys);
// Reads a .key file. kRefused where others than its owner may read it.
Result<KeyPair> ReadKeyPair(const std::filesystem::path& path);
// Reads the one key of a .pub file.
Result<std::string> ReadPublicKey(const std::filesystem::path& path);
// A public key a line, anything after it is a remark; a line that begins with '#' is one. kCorrupt names the
// line that holds no key.
Result<std::set<std::string>> ReadAllowList(const std::filesystem::path& path);

}  // namespace cairn::wire
