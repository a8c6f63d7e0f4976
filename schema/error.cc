#include "schema/error.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "schema/demands_throw.h"
#include "schema/text.h"

namespace cairn {
namespace {

thread_local bool t_demands_throw = false;

}  // namespace

InputError::InputError(const std::string& why) : std::runtime_error(Escaped(why)) {}

DemandsThrow::DemandsThrow() : before_(t_demands_throw) { t_demands_throw = true; }
DemandsThrow::~DemandsThrow() { t_demands_throw = before_; }

void DemandFailed(const char* condition, const char* file, int line, const std::string& message) {
  const std::string text =
      fmt::format("a bug: {} does not hold at {}:{}: {}", condition, file, line, message);
  if (t_demands_throw) throw std::logic_error(text);
  std::fprintf(stderr, "cairn: %s\n", text.c_str());
  std::abort();
}

}  // namespace cairn
