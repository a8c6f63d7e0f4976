// The rigid motion that lays a map over the truth where no poses say it.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "datasets/evaluate/matching/point_match.h"
#include "datasets/evaluate/matching/similarity.h"

namespace cairn::datasets {

using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;  // (estimate, truth)

std::vector<PointPair> PairUp(const std::vector<Point>& estimate, const std::vector<Point>& truth,
                              const IndexPairs& pairs);

// Looks for the rigid motion of the least GOSPA. Starts: the fit to `guess` where it has two pairs or more,
// and the motions that lay a pair of estimates on a pair of true points about as far apart; the best of them
// by nearest neighbours are improved by matching and fitting in turn. Without two points on each side: the
// shift between them. Deterministic; at most about a million starts are looked at.
Similarity SearchRigid(const std::vector<Point>& estimate, const std::vector<Point>& truth,
                       const MayMatch& may_match, const IndexPairs& guess);

}  // namespace cairn::datasets
