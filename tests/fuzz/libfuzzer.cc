// What libFuzzer calls. CAIRN_FUZZ_TARGET: the name of one of targets.h.
#include <google/protobuf/stubs/logging.h>

#include <cstdlib>

#include "schema/error.h"
#include "tests/fuzz/targets.h"

namespace {

const cairn::fuzz::Target& Chosen() {
  static const cairn::fuzz::Target chosen = [] {
    for (const cairn::fuzz::Target& target : cairn::fuzz::AllTargets())
      if (target.name == CAIRN_FUZZ_TARGET) return target;
    std::abort();
  }();
  return chosen;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);  // it complains of each text that is no UTF-8
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static_cast<void>(Chosen().run({data, size}));
  return 0;
}
