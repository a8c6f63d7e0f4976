// Which kind of file a stage's result is stored as (schema/FORMAT.md). The blob itself says it, so that a
// coordinator, which knows no pipeline, and a client, which fetches results, store the same.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn {

// landmark_map, grid_map, networks, localization, local_map, poses, samples, by the arrays that the kind must
// have; "result" where it is none of them.
std::string ResultKind(const Blob& result);

}  // namespace cairn
