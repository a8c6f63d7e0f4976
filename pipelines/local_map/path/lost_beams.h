// Beams of a laser that give no answer now and then, as cheap ones do: among neighbours that do answer, that
// says nothing of the room.
#pragma once

#include <span>
#include <vector>

#include "schema/geometry.h"

namespace cairn::local_map {

// Of each beam whether it is lost: it did not answer, and the next on either side that did are neighbours,
// or stand no more than four degrees apart. A wider gap is something else: nothing lies within reach there,
// or a thing that swallows the light. `beams`: in the order in which they stand; `answered`: one of each.
std::vector<bool> LostBeams(std::span<const Pose> beams, const std::vector<bool>& answered);

}  // namespace cairn::local_map
