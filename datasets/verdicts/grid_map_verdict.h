// How far a grid_map can be trusted.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/blob.h"

namespace cairn::datasets {

// Of a grid_map: by how many nats readings that were left out are likelier in the map of the others than in
// one that knows nothing (`fit/`), whether the search ended by itself, how many readings the map explains.
// Whether the poses are right it cannot tell: not known. Low: by less than 0.1.
Verdict GridMapVerdict(const Blob& result);

}  // namespace cairn::datasets
