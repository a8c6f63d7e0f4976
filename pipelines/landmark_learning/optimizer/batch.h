// Mini-batches: which true positions a step takes.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_learning/error_sum/pairs.h"

namespace cairn::landmark_learning {

inline constexpr int kStretch = 64;  // true positions side by side: they share the samples in their reach

// Stretches of true positions, drawn without replacement and sorted; together `batch` true positions or a
// little more, all of `count` where `batch` is 0 or as large. The same for one seed and step, whoever draws.
std::vector<IndexRange> DrawnStretches(int count, std::int64_t batch, std::uint64_t seed, std::int64_t step);

int TruePositionsIn(const std::vector<IndexRange>& stretches);

}  // namespace cairn::landmark_learning
