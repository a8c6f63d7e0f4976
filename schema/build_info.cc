#include "schema/build_info.h"

#include <string>

#include "schema/numerics.h"
#include "schema/sources.h"

#if defined(__GLIBC__)
#include <gnu/libc-version.h>
#endif

namespace cairn {
namespace {

std::string Compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "gcc " __VERSION__;
#endif
}

std::string Libc() {
#if defined(__GLIBC__)
  return std::string("glibc ") + gnu_get_libc_version();
#else
  return "unknown";
#endif
}

}  // namespace

const char* SourcesOfThisBuild() { return CAIRN_SOURCES; }

wire::Build ThisBuild() {
  wire::Build build;
  build.set_version(CAIRN_VERSION);
  build.set_sources(SourcesOfThisBuild());
  build.set_compiler(Compiler());
  build.set_flags(CAIRN_BUILD_FLAGS);
  build.set_libc(Libc());
  build.set_numeric_self_test(NumericSelfTest().Binary());
  return build;
}

}  // namespace cairn
