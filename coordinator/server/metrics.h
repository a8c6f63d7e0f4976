// What a service says of itself to who watches it: counts alone, no name of a job, a file, a host or a key.
// docs/monitoring.md lists the metrics; metrics_test.cc holds it against the code.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "coordinator/core/census.h"
#include "schema/wire/socket.h"

namespace cairn::coordinator {

struct Metrics {
  std::string version, compiler;
  Census census;
  Tally tally;
  Histogram turns;  // of the event loop: for so long who came then had to wait
  wire::Traffic traffic;
  std::map<std::string, std::uint64_t> refused;  // by kind (schema/wire/refusal.h)
  std::uint64_t store_bytes = 0;
  std::uint64_t store_limit_bytes = 0;  // 0: none
  std::uint64_t store_blobs = 0;
  bool store_writable = true;
  double last_checkpoint_utc_s = 0;  // 0: none since it began
};

// As Prometheus' text format 0.0.4 has it, a HELP and a TYPE for each.
std::string MetricsText(const Metrics& metrics);

}  // namespace cairn::coordinator
