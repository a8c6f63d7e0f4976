#include "schema/walked.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace cairn {

void LetGoOfMapped(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  const auto page = static_cast<std::uintptr_t>(::getpagesize());
  const auto begin = reinterpret_cast<std::uintptr_t>(bytes.data()) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(bytes.data() + bytes.size());
  ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
}

void MappedBlocks::Turn(std::size_t block, std::size_t block_bytes, std::span<const std::byte> bytes) {
  std::swap(now_, before_);
  if (now_ == block) return;
  const std::size_t gone = std::exchange(now_, block);
  if (gone < bytes.size() / block_bytes + 1) {
    const std::size_t at = std::min(gone * block_bytes, bytes.size());
    LetGoOfMapped(bytes.subspan(at, std::min(block_bytes, bytes.size() - at)));
  }
}

}  // namespace cairn
