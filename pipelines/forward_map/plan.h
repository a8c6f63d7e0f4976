// The rounds of forward_map: what each has to do, and its tasks, from the State alone.
#pragma once

#include <cstdint>

#include "pipelines/forward_map/state.h"
#include "pipelines/pipeline.h"

namespace cairn::forward_map {

// Tasks of the phase that `plan`'s state is in.
//   search     a tile; partial: proposals of one
//   weigh      a slice of a sensor's scans; partial: Evidence
//   certainty  a tile of the first split; partial: Certainty
//   explain    a sensor; partial: cause [S,B]
void PlanTasks(proto::Step* plan);

// After PlanTasks: what is expected to follow, with `rounds` searches at most.
void ExpectRest(std::int64_t rounds, bool estimate, proto::Step* plan);

}  // namespace cairn::forward_map
