// cairn-sim: runs the coordinator's core in simulated worlds, one a seed, and says which seeds break it.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>

#include "tests/simulation/world.h"

int main(int argc, char** argv) {
  std::uint64_t seeds = 1000, first = 1;
  bool traced = false;
  CLI::App app{
      "Runs Cairn's coordinator against simulated crashes, lost messages and full disks, a world a seed.\n"
      "Example: cairn-sim --seeds 10000; a seed that fails prints the command that replays it."};
  app.add_option("--seeds", seeds, "how many worlds")->capture_default_str();
  app.add_option("--first", first, "the first seed")->capture_default_str();
  app.add_flag("--trace", traced, "print every event and action");
  CLI11_PARSE(app, argc, argv);

  cairn::simulation::Trace trace;
  if (traced)
    trace = [](double now_s, const std::string& line) { std::printf("%10.4f  %s\n", now_s, line.c_str()); };
  std::uint64_t failed = 0, events = 0;
  double simulated_s = 0;
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const cairn::simulation::Outcome outcome = cairn::simulation::World(seed, trace).Run();
    events += outcome.events;
    simulated_s += outcome.simulated_s;
    if (outcome.violation.empty()) continue;
    ++failed;
    std::printf("seed %llu: %s\n  replay: cairn-sim --first %llu --seeds 1 --trace\n",
                static_cast<unsigned long long>(seed), outcome.violation.c_str(),
                static_cast<unsigned long long>(seed));
  }
  std::printf("%llu worlds, %llu failed; %llu events, %.1f simulated hours\n",
              static_cast<unsigned long long>(seeds), static_cast<unsigned long long>(failed),
              static_cast<unsigned long long>(events), simulated_s / 3600);
  return failed == 0 ? 0 : 1;
}
