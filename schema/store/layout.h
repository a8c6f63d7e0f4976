// How an array lies in a file: its unit, its chunks, whether deflate pays.
#pragma once

#include <string>
#include <string_view>

#include "schema/array.h"

namespace cairn::store {

// From the end of the name: "robot/0/odometry/time_s" -> "s", "noise/heading_drift_rad_per_m" -> "rad/m",
// else "1".
std::string UnitOf(std::string_view name);

// Chunks of about a MiB, cut along the first axes, of even size; a small array is one chunk.
// shape: no zero in it, at least one axis.
Shape ChunksOf(const Shape& shape, std::size_t item_bytes);

// Deflate (level 1, behind a byte shuffle) is used where at least three quarters of the bytes of an array of
// 64 KiB or more are zero, as in probability grids: it then writes and reads about as fast as it would
// without, and is several times smaller. Elsewhere it costs a factor of 30 in writing for little.
bool DeflatePays(const Array& array);

}  // namespace cairn::store
