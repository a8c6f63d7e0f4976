// Obstacles that came and went: persons who pass, in a map that holds the world to stand still.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/forward_map/flip_gains.h"

namespace cairn::forward_map {

// By how much the readings that meet an occupied cell are more likely, in nats, if there was an obstacle only
// from the first to the last reading that is of it (E[c_ik] above one half): each beam that passed the cell
// undetected at another time costs -log(1 - p_hit) in the map that stands still. 0 where beams passed it less
// than twice as often at other times as it was met, or where it never was: a wall that is seen at grazing
// angles is missed too, but not only then. time_s: of each reading of `gains`.
double CameAndWentNats(const FlipGains& gains, const std::vector<double>& time_s, std::int32_t cell);

}  // namespace cairn::forward_map
