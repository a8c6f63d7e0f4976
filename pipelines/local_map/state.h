// Where a job of local_map stands when a round begins: scalars of its State.
#pragma once

#include <cstdint>

#include "pipelines/common/state_scalars.h"

namespace cairn::local_map {

// What the round does.
enum class Phase : std::int32_t {
  kWalls,       // watches walls along dead reckoning
  kWallsAgain,  // and along the path that they corrected
  kTraces,      // records traces
  kPairs,       // matches nodes with traces, round after round
  kPasses,      // compares scans of places that were passed more than once
  kFollow,      // the live localizer
};

struct Standing {
  Phase phase = Phase::kWalls;
  std::int64_t robots = 0;
  std::int64_t round = 0;             // of pairs
  std::int64_t lasers = 0;            // robots that have one
  std::int64_t mends = 0;             // how often the path was sought anew where scans contradict it
  std::int64_t met = 0, doubled = 0;  // pairs of scans that agreed with the path before, and that did not
  static void Fields(const auto& field) {
    field("phase", &Standing::phase);
    field("robots", &Standing::robots);
    field("round", &Standing::round);
    field("lasers", &Standing::lasers);
    field("mends", &Standing::mends);
    field("met", &Standing::met);
    field("doubled", &Standing::doubled);
  }
};

}  // namespace cairn::local_map
