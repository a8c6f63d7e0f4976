// fuzz_bag_runs TARGET RUNS [FIRST]: so many mutations, from that number on. Where one brings the target
// down, its number is the last that is said.
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "tests/fuzz/mutate.h"
#include "tests/fuzz/targets.h"

namespace {

using namespace cairn::fuzz;

volatile unsigned long long at;

void SayWhere(int signal) {
  char text[64];
  const int length = std::snprintf(text, sizeof text, "run %llu: signal %d\n", at, signal);
  if (::write(STDERR_FILENO, text, static_cast<std::size_t>(length)) < 0) std::_Exit(2);
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

}  // namespace

int main(int argc, char** argv) {
  for (const Target& target : {BagTarget(), BagContainerTarget(), BagMessageTarget()}) {
    if (argc < 3 || target.name != argv[1]) continue;
    constexpr itimerval kMost{{}, {60, 0}};  // of processor time, for a thousand runs
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGPROF}) ::signal(signal, SayWhere);
    const unsigned long long runs = std::strtoull(argv[2], nullptr, 10),
                             first = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 0;
    const std::vector<Bytes> seeds = target.seeds();
    const auto began = std::chrono::steady_clock::now();
    unsigned long long accepted = 0;
    for (unsigned long long run = first; run < first + runs; ++run) {
      at = run;
      if (run % 1000 == 0) ::setitimer(ITIMER_PROF, &kMost, nullptr);
      cairn::Rng rng(1998, run);
      const Bytes bytes = Mutate(seeds[rng.Below(seeds.size())], &rng);
      accepted += target.run(bytes) == Outcome::kAccepted ? 1 : 0;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    std::printf("%s: %llu runs from %llu, %llu accepted, %.0f runs a second\n", argv[1], runs, first,
                accepted, static_cast<double>(runs) / seconds);
    return 0;
  }
  return std::fputs("usage: fuzz_bag_runs bag|bag_container|bag_message RUNS [FIRST]\n", stderr), 2;
}
