// A file that somebody names, opened for reading: nothing on which a reader could wait for ever.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>

#include "schema/error.h"

namespace cairn {

class RegularFile {
 public:
  // kNotFound; kRefused: no right to, or a folder, a FIFO, a device, a socket; kIo. The message names the
  // path.
  static Result<RegularFile> Open(const std::filesystem::path& path);
  RegularFile(RegularFile&& other) noexcept : fd_(std::exchange(other.fd_, -1)), size_(other.size_) {}
  RegularFile& operator=(RegularFile&&) = delete;
  ~RegularFile();

  int descriptor() const { return fd_; }
  std::uint64_t size() const { return size_; }  // in bytes, when it was opened
  // Fills `bytes` from byte `at` on. Returns errno, or 0; EIO where there are fewer.
  int ReadAt(std::span<std::byte> bytes, std::uint64_t at) const;

 private:
  RegularFile(int fd, std::uint64_t size) : fd_(fd), size_(size) {}
  int fd_;
  std::uint64_t size_;
};

// The whole of a small file, of a format of our own. kNotFound, kRefused, kIo as above; kCorrupt: it holds
// more than `most_bytes`.
Result<std::string> ReadSmallFile(const std::filesystem::path& path, std::size_t most_bytes);

}  // namespace cairn
