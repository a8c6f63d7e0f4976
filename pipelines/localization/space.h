// The positions over which the belief is held, with P(f | xi) at each.
#pragma once

#include <vector>

#include "pipelines/localization/belief.h"
#include "pipelines/localization/options.h"
#include "pipelines/localization/source.h"
#include "schema/blob.h"
#include "schema/kinds/fields.h"

namespace cairn::localization {

// The training locations, or the centres of the cells that have one within half a cell's diagonal (belief
// grid), row by row. Where headings count each has its own; a cell stands in up to four layers, for the
// quarters of the compass (around 0, 90, 180 and 270 degrees) in which training samples of it face, with
// their mean direction.
// Throws InputError where the cells' box has more than a million of them.
Poses BeliefPositions(const Options& options, const Source& source);

// What a task `map` finds for a block of positions, and together for all.
struct FeatureMap {
  std::vector<double> probability;  // P(f_i = 1 | xi): [positions][features]
  std::vector<double> room;         // [positions], see BeliefSpace

  static void Fields(const auto& field) {
    field("probability", &FeatureMap::probability);
    field("room", &FeatureMap::room);
  }
  void Append(const FeatureMap& block);
};

// `poses`: all of them; the block is first <= k < end. Where headings count, P(f | xi) is of the nearest
// training samples that face alike.
FeatureMap MapOfBlock(const Options& options, const Source& source, const Poses& poses, std::size_t first,
                      std::size_t end);

}  // namespace cairn::localization
