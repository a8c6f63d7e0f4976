#include "schema/error.h"

#include <cstdio>
#include <cstdlib>

namespace cairn {

void DemandFailed(const char* condition, const char* file, int line, const std::string& message) {
  std::fprintf(stderr, "cairn: a bug: %s does not hold at %s:%d: %s\n", condition, file, line,
               message.c_str());
  std::abort();
}

}  // namespace cairn
