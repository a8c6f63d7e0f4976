// A landmark map as a graph: what its log's odometry and observations say of its poses and landmarks.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "datasets/export/export.h"
#include "datasets/export/parts.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {

// Of paths whose poses are vertices one after the other, from 0 on, landmarks behind them:
// - from each pose to its robot's next one, the log's odometry without the errors that the result found of
// all
//   of it (where it found no scale, in the path's metre), and with the noise that it found or the log states;
// - from a pose to the landmark of each observation that the map was made of. An observation between two
// poses
//   is taken to the one before it by odometry, bent as the path is. It counts as the result's least squares
//   has it: in the widths that it found, with the weight that Cauchy's tails leave it where it lies now, and
//   less where successive observations of a landmark err in common.
// Throws InputError where the result is of another log.
std::string LandmarkMapEdges(const kinds::LandmarkMap& map, const kinds::Log& log,
                             const std::vector<Path>& paths, G2oLandmarks landmarks);

}  // namespace cairn::datasets
