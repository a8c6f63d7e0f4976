// Mutations from a seed, for the short fuzz tests that run everywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "schema/rng.h"

namespace cairn::fuzz {

using Bytes = std::vector<std::uint8_t>;

// One to eight small changes: flipped bits, bytes and words of interest put in, pieces cut out, doubled or
// moved, the end cut off. The same generator state gives the same bytes.
Bytes Mutate(Bytes bytes, Rng* rng);

}  // namespace cairn::fuzz
