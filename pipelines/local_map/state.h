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
  kFollow,      // the live localizer
};

struct Standing {
  Phase phase = Phase::kWalls;
  std::int64_t robots = 0;
  std::int64_t round = 0;  // of pairs
  static void Fields(const auto& field) {
    field("phase", &Standing::phase);
    field("robots", &Standing::robots);
    field("round", &Standing::round);
  }
};

}  // namespace cairn::local_map
