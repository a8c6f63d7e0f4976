#include "worker/task_memory.h"

#include <malloc.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>

#if defined(CAIRN_SANITIZED) || !defined(__GLIBC__)
#define CAIRN_COUNTS_MALLOC 0
#else
#define CAIRN_COUNTS_MALLOC 1
#endif

namespace cairn::worker {
namespace {

// Of this thread. No constructors: malloc is called before any of them could run.
thread_local bool t_held = false;
thread_local bool t_refused = false;
thread_local std::int64_t t_limit_bytes = 0;
thread_local std::int64_t t_taken_bytes = 0;

#if CAIRN_COUNTS_MALLOC

bool MayTake(std::size_t bytes) {
  if (!t_held || (bytes <= PTRDIFF_MAX && static_cast<std::int64_t>(bytes) <= t_limit_bytes - t_taken_bytes))
    return true;
  t_refused = true;
  errno = ENOMEM;
  return false;
}

void* Taken(void* block) {
  if (t_held && block != nullptr) t_taken_bytes += static_cast<std::int64_t>(malloc_usable_size(block));
  return block;
}

// What was not the task's may be freed here too.
void GivenBack(void* block) {
  if (!t_held || block == nullptr) return;
  t_taken_bytes =
      std::max<std::int64_t>(0, t_taken_bytes - static_cast<std::int64_t>(malloc_usable_size(block)));
}

#endif

}  // namespace

TaskMemory::TaskMemory(std::uint64_t job_mb, std::uint64_t worker_mb)
    : limit_mb_(job_mb == 0 || (worker_mb > 0 && worker_mb < job_mb) ? worker_mb : job_mb),
      by_job_(limit_mb_ == job_mb) {}

std::string TaskMemory::WhyRefused() const {
  if (!refused_) return "";
  return "it would have taken more than " + std::to_string(limit_mb_) + " MB of memory, " +
         (by_job_ ? "its limit (task_memory_mb)" : "this worker's limit for a task (--task-memory-mb)");
}

TaskMemory::Hold::Hold(TaskMemory& memory) : memory_(memory) {
  constexpr std::uint64_t kMostMb = std::uint64_t{INT64_MAX} >> 20;
  t_limit_bytes = static_cast<std::int64_t>(std::min(memory.limit_mb_, kMostMb) << 20);
  t_taken_bytes = 0;
  t_refused = false;
  t_held = memory.limit_mb_ > 0;
}

TaskMemory::Hold::~Hold() {
  t_held = false;
  memory_.refused_ |= t_refused;
}

TaskMemory::Pause::Pause() : held_(t_held) { t_held = false; }
TaskMemory::Pause::~Pause() { t_held = held_; }

}  // namespace cairn::worker

#if CAIRN_COUNTS_MALLOC

// These take the place of the C library's malloc, as its manual allows ("Replacing malloc"), count, and leave
// the work to it. What is not here (valloc) is not counted, and goes well with what is.
extern "C" {

void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* block);

void* malloc(std::size_t bytes) noexcept {
  return cairn::worker::MayTake(bytes) ? cairn::worker::Taken(__libc_malloc(bytes)) : nullptr;
}

void* calloc(std::size_t count, std::size_t bytes) noexcept {
  std::size_t all = 0;
  if (__builtin_mul_overflow(count, bytes, &all)) all = SIZE_MAX;
  return cairn::worker::MayTake(all) ? cairn::worker::Taken(__libc_calloc(count, bytes)) : nullptr;
}

void* realloc(void* block, std::size_t bytes) noexcept {
  const std::size_t had = malloc_usable_size(block);
  if (bytes > had && !cairn::worker::MayTake(bytes - had)) return nullptr;
  cairn::worker::GivenBack(block);
  void* const moved = __libc_realloc(block, bytes);
  const bool stays = moved == nullptr && bytes > 0;  // there was no memory
  cairn::worker::Taken(stays ? block : moved);
  return moved;
}

void free(void* block) noexcept {
  cairn::worker::GivenBack(block);
  __libc_free(block);
}

void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  return cairn::worker::MayTake(bytes) ? cairn::worker::Taken(__libc_memalign(alignment, bytes)) : nullptr;
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept { return memalign(alignment, bytes); }

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) noexcept {
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0 || alignment == 0) return EINVAL;
  void* const made = memalign(alignment, bytes);
  if (made == nullptr) return ENOMEM;
  *block = made;
  return 0;
}
}

#endif
