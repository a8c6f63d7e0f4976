// How far a local_map can be trusted.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/blob.h"

namespace cairn::datasets {

// Of a local_map: how many loops its path closes, how many contradict it, and how many go over the time over
// which the fewest do, for where a robot slipped or was carried what is before and after hangs together by
// chance alone (ends left out: a tenth of the way, of the first count 8 m at most). High: 20 loops over every
// time, ten of which tell how far along each axis, at most a fiftieth contradict the path. Low: fewer than
// five, or more than a fifth, or a way of more than 8 m, between those that tell how far along an axis the
// robot is, over which none does, or no wall within the local grids on half of the way and 20 m at a stretch,
// or walls that do not stand at right angles as the path supposes (wall_turns.h). How often each was right on
// simulated offices pipelines/local_map/EXPERIMENTS.md says. Not known where no loop was found, unless
// odometry would have to drift by a quarter turn or more. Low where scans show another motion than the path
// has or a hole in the log hides one; fair at most where the path took a turn from the scans that odometry
// missed. Low where two lasers of a robot see walls in different places.
// Low where scans of places that were passed more than once say that they are drawn twice: of a
// seventh of the passes, fair at most from half of that on.
Verdict LocalMapVerdict(const Blob& result);

// How far its local grids reach to each side; 0: not known.
double LocalGridsReach_m(const Blob& result);

}  // namespace cairn::datasets
