// A service under fire: a real coordinator and real workers, of which one is hurt every few seconds, while
// jobs of every registered pipeline go through. Every job must end with the bits that it has undisturbed.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace cairn::faults {

struct ChaosOptions {
  double seconds = 25;
  double every_s = 1.5;  // from fault to fault, on average
  std::uint64_t seed = 1;
  int workers = 3;
  int jobs = 3;  // under way at a time
};

struct ChaosReport {
  std::map<std::string, int> faults;  // how many of each kind
  std::map<std::string, int> done;    // jobs that gave the undisturbed bits, by case
  int submitted_again = 0;            // the coordinator was killed while it took a job
  double longest_job_s = 0;
  long coordinator_most_kb = 0;  // resident
  std::string problem;           // empty: none
};

// Everything lies in `folder`, which must be of mode 0700. It stays as it is where there was a problem.
ChaosReport RunChaos(const ChaosOptions& options, const std::string& folder);

}  // namespace cairn::faults
