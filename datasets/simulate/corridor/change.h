// What people do to a corridor between one month and the next.
#pragma once

#include "datasets/simulate/corridor/world.h"

namespace cairn::datasets::corridor {

// About so large a share of what hangs on the walls is replaced by another like it or taken away, of the
// doors is painted anew, of the bins is put elsewhere. Walls, lights and where doors are stay. `share`: 0
// to 1.
void ChangeWorld(double share, World* world, Rng& rng);

}  // namespace cairn::datasets::corridor
