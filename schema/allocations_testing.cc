#include "schema/allocations_testing.h"

#include <cstdlib>
#include <new>

namespace {
thread_local long allocations = 0;
}

// As std::stable_sort asks for it; else it would be a sanitizer's, and not for free().
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(bytes > 0 ? bytes : 1);
}
void* operator new(std::size_t bytes) {
  if (void* block = ::operator new(bytes, std::nothrow)) return block;
  throw std::bad_alloc();
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }

namespace cairn {

long Allocations() { return allocations; }

}  // namespace cairn
