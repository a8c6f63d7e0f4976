// What the system lets a process have (ulimit), looked at before it begins: what runs out later shows where
// nobody expects it, and the libraries below end the process over it.
#pragma once

#include <cstdint>
#include <filesystem>

#include "schema/error.h"

namespace cairn {

struct ProcessNeeds {
  std::uint64_t files = 32;             // open at a time, beside those that it was started with
  std::uint64_t file_bytes = 0;         // of the largest that it writes, at the least
  std::uint64_t memory_bytes = 0;       // addresses, at the least
  std::uint64_t stack_bytes = 1 << 20;  // of each thread, at the least
  std::uint64_t threads = 4;            // and processes, beside those of this user that there are
};

// Raises the soft limit on open files where that is what is in the way. From now on a file that would grow
// over its limit is a write that fails, which is told, not the process's silent end; and what libprotobuf has
// to say of bytes that it cannot read, in lines of its own and unescaped, is for nobody: whoever reads them
// says what is wrong; and no file takes the number of a standard stream that is closed, with what is written
// there. kRefused: which limit is too low, what it is and what is needed.
Status PrepareProcess(const ProcessNeeds& needs);

// What a process may take of this machine: its memory, or the least that a limit on the process or on a group
// that it is in (a container, a unit, a batch job) leaves of it.
std::uint64_t MemoryToHave(const std::filesystem::path& group_of_process = "/proc/self/cgroup",
                           const std::filesystem::path& groups = "/sys/fs/cgroup");

}  // namespace cairn
