// Errors between positions that no formula gives: a user's table, or paths through a map.
#pragma once

#include "pipelines/landmark_learning/data/training_data.h"

namespace cairn::landmark_learning {

inline constexpr std::int64_t kMostTableRows = 4096;  // a table of 64 MB

// Gives each sample the row of the position nearest to it. `errors`: schema/FORMAT.md, `errors`, checked as
// its kind. Throws InputError where there are no positions, or more than kMostTableRows.
void AttachTable(const Blob& errors, TrainingData* data);

// e is the way that a robot travels between two samples through the free cells of `map` (schema/FORMAT.md,
// `grid_map`; free: P(occupied) below 1/2, and cells that were never looked at): the shortest over steps to
// the 16 cells around, at most 2.8% longer than the straight line where nothing is in the way. Samples of one
// cell are at one position.
// Throws InputError that names the sample which lies in no free cell.
// Throws InputError that names two samples where no way leads from one to the other.
// Throws InputError where the samples lie in more than kMostTableRows cells.
void AttachTravel(const Blob& map, TrainingData* data);

}  // namespace cairn::landmark_learning
