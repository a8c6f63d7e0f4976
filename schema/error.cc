#include "schema/error.h"

#include <cstdio>
#include <cstdlib>

#include "schema/text.h"

namespace cairn {

InputError::InputError(const std::string& why) : std::runtime_error(Escaped(why)) {}

void DemandFailed(const char* condition, const char* file, int line, const std::string& message) {
  std::fprintf(stderr, "cairn: a bug: %s does not hold at %s:%d: %s\n", condition, file, line,
               message.c_str());
  std::abort();
}

}  // namespace cairn
