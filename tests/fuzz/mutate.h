// Mutations from a seed, for the short fuzz tests that run everywhere.
#pragma once

#include "schema/rng.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {

// One to eight small changes: flipped bits, bytes and words of interest put in, pieces cut out, doubled or
// moved, the end cut off. The same generator state gives the same bytes.
Bytes Mutate(Bytes bytes, Rng* rng);

}  // namespace cairn::fuzz
