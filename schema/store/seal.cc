#include "schema/store/seal.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "schema/hash.h"
#include "schema/store/atomic_file.h"

namespace cairn::store {
namespace {

constexpr std::array<char, 8> kMagic{'C', 'A', 'I', 'R', 'N', 'S', 'U', 'M'};

std::array<std::byte, kSealBytes> SealOf(const Hasher& hasher) {
  std::array<std::byte, kSealBytes> seal;
  const Hash hash = hasher.Finish();
  std::memcpy(seal.data(), kMagic.data(), kMagic.size());
  std::memcpy(seal.data() + kMagic.size(), hash.bytes.data(), hash.bytes.size());
  return seal;
}

Status Judge(const std::string& name, const std::array<std::byte, kSealBytes>& want,
             std::span<const std::byte> have) {
  if (std::memcmp(have.data(), kMagic.data(), kMagic.size()) != 0)
    return {Code::kCorrupt, name + ": damaged: it lacks the seal of a file that was written whole"};
  if (!std::ranges::equal(have, want))
    return {Code::kCorrupt, name + ": damaged: its bytes are not those that were written"};
  return Status::Ok();
}

Status TooShort(const std::string& name) {
  return {Code::kCorrupt, name + ": damaged: too short for a seal"};
}

// Closed with the object.
struct Descriptor {
  int fd;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

// Returns errno, or 0; EIO where there are fewer.
int ReadAt(int fd, std::span<std::byte> bytes, off_t at) {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(fd, bytes.data(), bytes.size(), at);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    at += count;
  }
  return 0;
}

}  // namespace

std::array<std::byte, kSealBytes> SealOf(std::span<const std::byte> bytes) {
  Hasher hasher;
  hasher.Add(bytes);
  return SealOf(hasher);
}

Status CheckSeal(std::span<const std::byte> image, const std::string& name) {
  if (image.size() < kSealBytes) return TooShort(name);
  const std::size_t size = image.size() - kSealBytes;
  return Judge(name, SealOf(image.first(size)), image.subspan(size));
}

Status CheckSeal(const std::filesystem::path& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat info{};
  if (file.fd < 0 || ::fstat(file.fd, &info) != 0) return SystemFailure(path, "cannot open", errno);
  if (!S_ISREG(info.st_mode)) return {Code::kIo, path.string() + ": is not a file"};
  if (info.st_size < static_cast<off_t>(kSealBytes)) return TooShort(path.string());
  const off_t end = info.st_size - static_cast<off_t>(kSealBytes);
  Hasher hasher;
  std::vector<std::byte> part(std::size_t{1} << 18);
  for (off_t at = 0; at < end;) {
    const auto count = std::min<std::size_t>(part.size(), static_cast<std::size_t>(end - at));
    if (const int error = ReadAt(file.fd, std::span(part).first(count), at))
      return SystemFailure(path, "cannot read", error);
    hasher.Add(std::span<const std::byte>(part).first(count));
    at += static_cast<off_t>(count);
  }
  std::array<std::byte, kSealBytes> have;
  if (const int error = ReadAt(file.fd, have, end)) return SystemFailure(path, "cannot read", error);
  return Judge(path.string(), SealOf(hasher), have);
}

bool HasSeal(const std::filesystem::path& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat info{};
  if (file.fd < 0 || ::fstat(file.fd, &info) != 0 || info.st_size < static_cast<off_t>(kSealBytes))
    return false;
  std::array<std::byte, kMagic.size()> have;
  return ReadAt(file.fd, have, info.st_size - static_cast<off_t>(kSealBytes)) == 0 &&
         std::memcmp(have.data(), kMagic.data(), kMagic.size()) == 0;
}

}  // namespace cairn::store
