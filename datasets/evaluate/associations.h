// Which observation belongs to which landmark, in a result and in truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "datasets/evaluate/align.h"
#include "schema/blob.h"

namespace cairn::datasets {

// For each robot, for each observation, a landmark's index or -1.
using Associations = std::vector<std::vector<std::int32_t>>;

// robot/N/observations/map_landmark. Throws InputError where one is missing, is not as long as the log's
// observations, or names a landmark outside [-1, landmarks).
Associations ReadMapAssociations(const Blob& result, const Blob& log, std::size_t landmarks);

// truth/robot/N/observations/landmark; nothing where a robot with observations lacks it. Throws InputError as
// above.
std::optional<Associations> ReadTrueAssociations(const Blob& log, std::size_t landmarks);

// True where `map` partitions the observations exactly as `truth` does, -1 where truth says -1, and each of
// the map's `landmarks` has an observation.
bool SamePartition(const Associations& map, const Associations& truth, std::size_t landmarks);

// The true landmark that most observations of each map landmark belong to, where it has any.
IndexPairs MajorityPairs(const Associations& map, const Associations& truth, std::size_t landmarks);

}  // namespace cairn::datasets
