#include "schema/walked.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace cairn {

namespace {

void Advise(std::span<const std::byte> bytes, int advice) {
  if (bytes.empty()) return;
  const auto page = static_cast<std::uintptr_t>(::getpagesize());
  const auto begin = reinterpret_cast<std::uintptr_t>(bytes.data()) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(bytes.data() + bytes.size());
  ::madvise(reinterpret_cast<void*>(begin), end - begin, advice);
}

}  // namespace

void LetGoOfMapped(std::span<const std::byte> bytes) { Advise(bytes, MADV_DONTNEED); }

void MappedBlocks::Turn(std::size_t block, std::size_t block_bytes, std::span<const std::byte> bytes,
                        bool to_write) {
  std::swap(now_, before_);
  if (now_ == block) return;
  const std::size_t gone = std::exchange(now_, block);
  if (bytes.empty()) return;
  const auto in_block = [&](std::size_t which) {
    const std::size_t at = std::min(which * block_bytes, bytes.size());
    return bytes.subspan(at, std::min(block_bytes, bytes.size() - at));
  };
  if (gone <= bytes.size() / block_bytes) LetGoOfMapped(in_block(gone));
  // At once, which is cheaper than page by page; a kernel before 5.14 does not know how.
  Advise(in_block(block), to_write ? MADV_POPULATE_WRITE : MADV_POPULATE_READ);
}

}  // namespace cairn
