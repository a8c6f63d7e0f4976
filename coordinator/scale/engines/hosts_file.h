// The hosts on which workers may run:
//
//   HOST CORES [MEMORY_MB]
//
// a line each, a worker a core, which share that memory. What follows a '#' is a remark.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cairn::coordinator {

struct Host {
  std::string name;  // as ssh takes it: desk, ann@desk
  int cores = 1;
  std::uint64_t memory_mb = 0;  // of all its workers' tasks; 0: no limit
};

// `file`: for messages.
// Throws InputError, with the line, where it is none or names a host twice.
std::vector<Host> ParseHosts(const std::string& text, const std::string& file);

}  // namespace cairn::coordinator
