#include "schema/store/regular_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "schema/store/atomic_file.h"

namespace cairn {
namespace {

const char* WhatItIs(mode_t mode) {
  if (S_ISDIR(mode)) return "is a folder, not a file";
  if (S_ISFIFO(mode)) return "is a FIFO, which is not read: copy what comes out of it to a file";
  if (S_ISSOCK(mode)) return "is a socket, not a file";
  return "is a device, not a file";
}

}  // namespace

Result<RegularFile> RegularFile::Open(const std::filesystem::path& path) {
  // Looked at before it is opened, which does something to some devices, and after, for it may be another by
  // then. Without O_NONBLOCK a FIFO would wait for its writer.
  struct stat info{};
  if (::stat(path.c_str(), &info) != 0) return SystemFailure(path, "cannot open", errno);
  if (!S_ISREG(info.st_mode)) return Status(Code::kRefused, path.string() + ": " + WhatItIs(info.st_mode));
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0) return SystemFailure(path, "cannot open", errno);
  RegularFile file(fd, 0);
  if (::fstat(fd, &info) != 0) return SystemFailure(path, "cannot open", errno);
  if (!S_ISREG(info.st_mode)) return Status(Code::kRefused, path.string() + ": " + WhatItIs(info.st_mode));
  file.size_ = static_cast<std::uint64_t>(info.st_size);
  return file;
}

RegularFile::~RegularFile() {
  if (fd_ >= 0) ::close(fd_);
}

int RegularFile::ReadAt(std::span<std::byte> bytes, std::uint64_t at) const {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(fd_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    at += static_cast<std::uint64_t>(count);
  }
  return 0;
}

Result<std::string> ReadSmallFile(const std::filesystem::path& path, std::size_t most_bytes) {
  const Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) return file.status();
  if (file.value().size() > most_bytes)
    return Status(Code::kCorrupt, path.string() + ": " + std::to_string(file.value().size()) +
                                      " bytes; no such file has more than " + std::to_string(most_bytes));
  std::string text(file.value().size(), '\0');
  if (const int error = file.value().ReadAt(std::as_writable_bytes(std::span(text)), 0); error != 0)
    return SystemFailure(path, "cannot read", error);
  return text;
}

}  // namespace cairn
