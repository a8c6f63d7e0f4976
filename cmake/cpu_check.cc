// Says so plainly, before anything else runs, where the CPU lacks instructions that this build uses: without
// it the first vector instruction ends the process with SIGILL. Compiled for the plainest x86-64, so that it
// runs anywhere.
#if defined(__x86_64__) && defined(CAIRN_NEEDS_X86_64_V3)
#include <unistd.h>

namespace {

// Priority 101 is the earliest that programs may use: static constructors of the program come after it.
[[gnu::constructor(101)]] void CheckCpu() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
    return;
  constexpr char kMessage[] =
      "cairn: this CPU is below x86-64-v3 (AVX2, FMA, BMI2), which this build targets; build with "
      "cmake --preset release -DCAIRN_MARCH=x86-64 (all machines of a fleet must run the same build)\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  _exit(2);
}

}  // namespace
#endif
