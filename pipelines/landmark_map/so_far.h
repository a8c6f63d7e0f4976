// The map as far as it has come, for people to look at while the stage runs (schema/FORMAT.md, map_so_far).
#pragma once

#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// Puts into the State of `step` what it shows: of several starts the one whose map explains most of the data
// best. `state`, `inputs`: of the round that `step` follows. Nothing before there is a map.
void ShowSoFar(const State& state, const Inputs& inputs, cairn::Step* step);

}  // namespace cairn::landmark_map
