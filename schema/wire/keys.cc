#include "schema/wire/keys.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

namespace cairn::wire {
namespace {

constexpr std::size_t kKeyChars = 40;

bool IsKey(const std::string& text) {
  std::array<std::uint8_t, 32> bytes;
  return text.size() == kKeyChars && zmq_z85_decode(bytes.data(), text.c_str()) != nullptr;
}

Status WriteNew(const std::filesystem::path& path, const std::string& text, mode_t mode) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (fd < 0) {
    // Whatever else is wrong with the place, another has to be named.
    const Code code = errno == EEXIST ? Code::kBusy : errno == ENOSPC ? Code::kNoSpace : Code::kRefused;
    return {code, path.string() + ": " + std::strerror(errno)};
  }
  const bool written =
      ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(fd) == 0;
  const std::string why = std::strerror(errno);
  ::close(fd);
  if (written) return Status::Ok();
  ::unlink(path.c_str());
  return {Code::kIo, path.string() + ": " + why};
}

Result<std::vector<std::string>> ReadLines(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return Status(Code::kNotFound, path.string() + ": " + std::strerror(errno));
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

// The first word of each line that has one, each a key.
Result<std::vector<std::string>> ReadKeys(const std::filesystem::path& path) {
  const Result<std::vector<std::string>> lines = ReadLines(path);
  if (!lines.ok()) return lines.status();
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < lines.value().size(); ++i) {
    std::istringstream words(lines.value()[i]);
    std::string key;
    if (!(words >> key)) continue;
    // A key may itself begin with '#'.
    if (key.starts_with('#') && !IsKey(key)) continue;
    if (!IsKey(key)) {
      return Status(Code::kCorrupt,
                    path.string() + ":" + std::to_string(i + 1) + ": not a key of 40 characters");
    }
    keys.push_back(key);
  }
  return keys;
}

}  // namespace

KeyPair GenerateKeyPair() {
  std::array<char, kKeyChars + 1> public_key{};
  std::array<char, kKeyChars + 1> secret_key{};
  CAIRN_DEMAND(zmq_curve_keypair(public_key.data(), secret_key.data()) == 0, "libzmq lacks CURVE");
  return {public_key.data(), secret_key.data()};
}

Status WriteKeyPair(const std::filesystem::path& stem, const KeyPair& keys) {
  const std::string secret = "# Cairn key pair: public, then secret. Keep this file to yourself.\n" +
                             keys.public_key + " public\n" + keys.secret_key + " secret\n";
  if (Status s = WriteNew(stem.string() + ".key", secret, 0600); !s.ok()) return s;
  return WriteNew(stem.string() + ".pub", keys.public_key + "\n", 0644);
}

Result<KeyPair> ReadKeyPair(const std::filesystem::path& path) {
  struct stat info;
  if (::stat(path.c_str(), &info) != 0)
    return Status(Code::kNotFound, path.string() + ": " + std::strerror(errno));
  if ((info.st_mode & 077) != 0) {
    return Status(Code::kRefused, path.string() + ": others can read this secret key; chmod 600 it");
  }
  const Result<std::vector<std::string>> keys = ReadKeys(path);
  if (!keys.ok()) return keys.status();
  std::array<char, kKeyChars + 1> derived{};
  if (keys.value().size() != 2 || zmq_curve_public(derived.data(), keys.value()[1].c_str()) != 0 ||
      keys.value()[0] != derived.data()) {
    return Status(Code::kCorrupt, path.string() + ": not a key pair");
  }
  return KeyPair{keys.value()[0], keys.value()[1]};
}

Result<std::string> ReadPublicKey(const std::filesystem::path& path) {
  const Result<std::vector<std::string>> keys = ReadKeys(path);
  if (!keys.ok()) return keys.status();
  if (keys.value().size() != 1) return Status(Code::kCorrupt, path.string() + ": not one public key");
  return keys.value()[0];
}

Result<std::set<std::string>> ReadAllowList(const std::filesystem::path& path) {
  const Result<std::vector<std::string>> keys = ReadKeys(path);
  if (!keys.ok()) return keys.status();
  return std::set<std::string>(keys.value().begin(), keys.value().end());
}

}  // namespace cairn::wire
