// What a coordinator takes of a pipeline's step, for pipelines whose State grows with an option.
#pragma once

#include <cstddef>

namespace cairn {

// Scalars of a State, and as many blobs: it goes with every task, and is copied for it; a pipeline's own has
// some dozens.
inline constexpr std::size_t kMostFigures = 20'000;

// Of what a step costs, or expects to follow it: sums of more would be no times.
inline constexpr double kMostAmount = 1e15;

}  // namespace cairn
