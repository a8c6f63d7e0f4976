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

void LetGoOfMapped(std::span<const std::byte> all, std::size_t at, std::size_t count) {
  // Who looks at a page gets those about it too, as many as the kernel keeps together: of what was let go.
  constexpr std::size_t kTogether = std::size_t{1} << 21;
  const std::size_t from = at - std::min(kTogether, at);
  Advise(all.subspan(from, at - from + count), MADV_DONTNEED);
}

void MappedBlocks::Turn(std::size_t block, std::size_t block_bytes, std::span<const std::byte> bytes,
                        bool to_write) {
  std::swap(now_, before_);
  if (now_ == block) return;
  const std::size_t gone = std::exchange(now_, block);
  if (bytes.empty()) return;
  const auto size_at = [&](std::size_t at) { return std::min(block_bytes, bytes.size() - at); };
  if (gone < bytes.size() / block_bytes)
    LetGoOfMapped(bytes, gone * block_bytes, size_at(gone * block_bytes));
  // At once, which is cheaper than page by page; a kernel before 5.14 does not know how.
  const std::size_t at = std::min(block * block_bytes, bytes.size());
  Advise(bytes.subspan(at, size_at(at)), to_write ? MADV_POPULATE_WRITE : MADV_POPULATE_READ);
}

}  // namespace cairn
