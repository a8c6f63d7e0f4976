// What there is to count in the core, for whoever watches the service. Nothing here decides anything.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace cairn::coordinator {

// How many of what was measured, in seconds, were at most as long as each bound.
struct Histogram {
  static constexpr std::array kBounds_s = {0.001, 0.003, 0.01, 0.03, 0.1,    0.3,    1.0,     3.0,
                                           10.0,  30.0,  100., 300., 1000.0, 3000.0, 10'000.0};
  std::array<std::uint64_t, kBounds_s.size() + 1> counts{};  // each of its own bucket; the last has no bound
  double sum_s = 0;

  void Add(double seconds) {
    const auto bound = std::ranges::lower_bound(kBounds_s, seconds);
    ++counts[static_cast<std::size_t>(bound - kBounds_s.begin())];
    sum_s += seconds;
  }
};

// Since the coordinator began. What jobs took along that are deleted stays in it.
struct Tally {
  std::uint64_t tasks_done = 0;  // answers that were accepted
  std::uint64_t retries = 0;     // attempts that failed
  std::uint64_t lost = 0;        // attempts that were lost with their machines
  std::uint64_t checkpoints = 0;
  std::uint64_t checkpoint_failures = 0;
  Histogram rounds;  // from a round's plan to the next
};

// As it stands.
struct Census {
  std::map<std::string, std::uint64_t> jobs, workers;  // by state, each state there is
  std::uint64_t tasks_running = 0;                     // of running jobs: dispatched
  std::uint64_t tasks_waiting = 0;                     // and those of their rounds that are not yet
  double waiting_work_s = 0;                           // what these will take, on one worker
};

}  // namespace cairn::coordinator
