#include "schema/wire/keys.h"

#include <fcntl.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <vector>

namespace cairn::wire {
namespace {

constexpr std::size_t kKeyChars = 40;
constexpr std::size_t kMostBytes = 4096;  // of a key file

void Wipe(std::string& text) { ::explicit_bzero(text.data(), text.size()); }

Status WriteNew(const std::filesystem::path& path, const std::string& text, mode_t mode) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (fd < 0) {
    // Whatever else is wrong with the place, another has to be named.
    const Code code = errno == EEXIST ? Code::kBusy : errno == ENOSPC ? Code::kNoSpace : Code::kRefused;
    return {code, path.string() + ": " + ::strerror(errno)};
  }
  const bool written =
      ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(fd) == 0;
  const std::string why = ::strerror(errno);
  ::close(fd);
  if (written) return Status::Ok();
  ::unlink(path.c_str());
  return {Code::kIo, path.string() + ": " + why};
}

// Says why a file that holds a secret may not be used; asked of the open file, so that it cannot change
// after.
std::string WhyUnsafe(int fd) {
  struct stat info{};
  if (::fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) return "not a file";
  if (info.st_uid != ::geteuid()) return "this secret key belongs to another user";
  return (info.st_mode & 077) == 0 ? "" : "others can read this secret key; chmod 600 it";
}

// Why a public key may be anybody's: whoever can write to it, or to its folder, chooses whom it names.
std::string WhyAnybodys(int fd, const std::filesystem::path& path) {
  struct stat file{}, folder{};
  if (::fstat(fd, &file) == 0 && S_ISREG(file.st_mode) && (file.st_mode & S_IWOTH) != 0)
    return "anybody can write to this key; chmod o-w it";
  const std::filesystem::path parent = std::filesystem::absolute(path).parent_path();
  const bool known = ::stat(parent.c_str(), &folder) == 0;
  if (known && (folder.st_mode & S_IWOTH) != 0 && (folder.st_mode & S_ISVTX) == 0)
    return "anybody can put another key in its place; chmod o-w " + parent.string();
  return "";
}

// The file's text; the caller wipes it.
Result<std::string> ReadText(const std::filesystem::path& path, bool secret) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return Status(Code::kNotFound, path.string() + ": " + ::strerror(errno));
  if (const std::string why = secret ? WhyUnsafe(fd) : WhyAnybodys(fd, path); !why.empty()) {
    ::close(fd);
    return Status(Code::kRefused, path.string() + ": " + why);
  }
  std::string text(kMostBytes, '\0');
  const ssize_t got = ::read(fd, text.data(), text.size());
  ::close(fd);
  text.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
  return text;
}

// The first word of each line that has one, each a key, as views into `text`. Empty where one is not.
std::vector<std::string_view> KeysIn(std::string_view text) {
  std::vector<std::string_view> keys;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) continue;
    const std::string_view word = line.substr(first, line.find_first_of(" \t\r", first) - first);
    const bool is_key = IsPublicKey(word);
    if (!is_key && word.starts_with('#')) continue;  // a key may itself begin with '#'
    if (!is_key) return {};
    keys.push_back(word);
  }
  return keys;
}

}  // namespace

KeyPair::~KeyPair() { Wipe(secret_key); }

KeyPair GenerateKeyPair() {
  std::array<char, kKeyChars + 1> public_key{};
  std::array<char, kKeyChars + 1> secret_key{};
  CAIRN_DEMAND(zmq_curve_keypair(public_key.data(), secret_key.data()) == 0, "libzmq lacks CURVE");
  KeyPair keys{public_key.data(), secret_key.data()};
  ::explicit_bzero(secret_key.data(), secret_key.size());
  return keys;
}

bool IsPublicKey(std::string_view text) {
  if (text.size() != kKeyChars) return false;
  std::array<char, kKeyChars + 1> copy{};  // it may be a secret that is looked at
  std::array<std::uint8_t, 32> bytes{};
  text.copy(copy.data(), kKeyChars);
  const bool is_key = zmq_z85_decode(bytes.data(), copy.data()) != nullptr;
  ::explicit_bzero(copy.data(), copy.size());
  ::explicit_bzero(bytes.data(), bytes.size());
  return is_key;
}

std::string ShortKey(const std::string& public_key) {
  return public_key.empty() ? "no key" : "key " + public_key.substr(0, 8) + "...";
}

Status WriteKeyPair(const std::filesystem::path& stem, const KeyPair& keys) {
  std::string secret = "# Cairn key pair: public, then secret. Keep this file to yourself.\n" +
                       keys.public_key + " public\n" + keys.secret_key + " secret\n";
  const Status written = WriteNew(stem.string() + ".key", secret, 0600);
  Wipe(secret);
  if (!written.ok()) return written;
  const Status handed_out = WriteNew(stem.string() + ".pub", keys.public_key + "\n", 0644);
  if (!handed_out.ok()) ::unlink((stem.string() + ".key").c_str());  // the public key there is not its own
  return handed_out;
}

Result<KeyPair> ReadKeyPair(const std::filesystem::path& path) {
  Result<std::string> text = ReadText(path, true);
  if (!text.ok()) return text.status();
  ::prctl(PR_SET_DUMPABLE, 0);
  const std::vector<std::string_view> keys = KeysIn(text.value());
  KeyPair pair;
  if (keys.size() == 2) pair = {std::string(keys[0]), std::string(keys[1])};
  Wipe(text.value());
  std::array<char, kKeyChars + 1> derived{};
  if (keys.size() != 2 || zmq_curve_public(derived.data(), pair.secret_key.c_str()) != 0 ||
      pair.public_key != derived.data()) {
    return Status(Code::kCorrupt, path.string() + ": not a key pair");
  }
  return pair;
}

Result<std::string> ReadPublicKey(const std::filesystem::path& path) {
  const Result<std::string> text = ReadText(path, false);
  if (!text.ok()) return text.status();
  const std::vector<std::string_view> keys = KeysIn(text.value());
  if (keys.size() != 1) return Status(Code::kCorrupt, path.string() + ": not one public key");
  return std::string(keys[0]);
}

}  // namespace cairn::wire
