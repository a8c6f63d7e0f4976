#include "pipelines/local_map/testing/allocations.h"

#include <cstdlib>
#include <new>

namespace {
long allocations = 0;  // of tests, which have one thread
}

void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* block = std::malloc(bytes > 0 ? bytes : 1)) return block;
  throw std::bad_alloc();
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }

namespace cairn::local_map {

long Allocations() { return allocations; }

}  // namespace cairn::local_map
