// What the main functions of benchmarks do: bad arguments and input end with 2 and the reason.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "schema/error.h"
#include "schema/numerics.h"

namespace cairn {

inline int BenchMain(const char* name, int (*main)(const std::vector<std::string>& args), int argc,
                     char** argv) {
  try {
    FixNumericsOfProcess();
    return main({argv + 1, argv + argc});
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 2;
  }
}

}  // namespace cairn
