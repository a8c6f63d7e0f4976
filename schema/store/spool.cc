#include "schema/store/spool.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <utility>

#include "schema/store/atomic_file.h"

namespace cairn {
namespace {

constexpr std::size_t kSpoolPiece = 1 << 20;

// Returns errno, or 0.
int WriteAt(int fd, std::span<const std::byte> bytes, std::uint64_t at) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(fd, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    at += static_cast<std::uint64_t>(count);
  }
  return 0;
}

}  // namespace

int OpenNamelessFile(const std::filesystem::path& folder, int* error) {
  int fd = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (fd >= 0) return fd;
  std::string name = folder / ".cairn-spool.XXXXXX";
  fd = ::mkostemp(name.data(), O_CLOEXEC);
  *error = fd < 0 ? errno : 0;
  if (fd >= 0) ::unlink(name.c_str());
  return fd;
}

Spool::Spool(Spool&& other) noexcept { *this = std::move(other); }

Spool& Spool::operator=(Spool&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(last_, other.last_);
  std::swap(written_, other.written_);
  std::swap(fd_, other.fd_);
  std::swap(error_, other.error_);
  return *this;
}

Spool::~Spool() {
  if (fd_ >= 0) ::close(fd_);
}

void Spool::AddBytes(std::span<const std::byte> bytes) {
  last_.insert(last_.end(), bytes.begin(), bytes.end());
  if (!folder_.empty() && last_.size() >= kSpoolPiece) Flush();
}

void Spool::Flush() {
  if (fd_ < 0 && error_ == 0) fd_ = OpenNamelessFile(folder_, &error_);
  if (error_ == 0) error_ = WriteAt(fd_, last_, written_);
  written_ += last_.size();
  last_.clear();
}

Result<Array> Spool::Take(DType type, std::size_t item_bytes, const Shape& shape) {
  if (written_ > 0 && !last_.empty()) Flush();
  if (error_ != 0) return SystemFailure(folder_, "cannot write what is read", error_);
  if (written_ == 0) return Array::FromBytes(type, item_bytes, shape, std::exchange(last_, {}));
  last_ = {};
  const std::size_t size = std::exchange(written_, 0);
  void* const bytes = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, fd_, 0);
  const int error = errno;
  ::close(std::exchange(fd_, -1));
  if (bytes == MAP_FAILED) return SystemFailure(folder_, "cannot read what was read", error);
  const std::shared_ptr<const std::byte> owner(
      static_cast<const std::byte*>(bytes),
      [size](const std::byte* of) { ::munmap(const_cast<std::byte*>(of), size); });
  return Array::OverFile(type, item_bytes, shape, {owner.get(), size}, owner);
}

}  // namespace cairn
