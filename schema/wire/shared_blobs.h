// Blobs in memory that the processes of one machine share. Whoever starts others writes blobs there once;
// they read them where they lie, so that nobody sends them and nobody has a copy of its own. Sealed: what was
// written never changes. The system takes the memory back when the last of them has ended.
#pragma once

#include <span>
#include <vector>

#include "schema/wire/codec.h"

namespace cairn::wire {

// The writer's descriptor. A process that is started inherits it once its FD_CLOEXEC is taken away.
class SharedMemory {
 public:
  SharedMemory() = default;
  explicit SharedMemory(int fd) : fd_(fd) {}
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&& other) noexcept;
  ~SharedMemory();

  int descriptor() const { return fd_; }  // -1: none

 private:
  int fd_ = -1;
};

// kNoSpace, kIo: the system has no such memory to give.
Result<SharedMemory> ShareBlobs(std::span<const NamedBlob> blobs);

// In another process, and once: takes the descriptor over. kCorrupt: not sealed, or not what ShareBlobs
// writes; hashes are checked as those of a message are.
Result<std::vector<NamedBlob>> TakeSharedBlobs(int fd);

}  // namespace cairn::wire
