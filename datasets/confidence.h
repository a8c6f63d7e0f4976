// How sure a map is, in words: what `search/` in the result says.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::datasets {

// "high among the maps tried: 57.2 nats ahead of the next different one of 5 starts"; "low" below 3 nats (the
// next one is not twenty times less likely), "fair" below 10. Where every start found the same map, or there
// was but one, it says that. No lead says that a better map, which was not tried, does not exist.
std::string ConfidenceText(const Blob& result);

}  // namespace cairn::datasets
