// The places over which the belief is held, with P(f | xi) at each.
#pragma once

#include <vector>

#include "pipelines/localization/belief.h"
#include "pipelines/localization/options.h"
#include "pipelines/localization/source.h"
#include "schema/blob.h"

namespace cairn::localization {

// The training locations, or the centres of the cells that have one within half a cell's diagonal (belief
// grid), row by row. Throws InputError where they would be too many.
std::vector<Place> BeliefPlaces(const Options& options, const std::vector<Place>& training);

// What a task `map` finds for a block of places, and together for all.
struct FeatureMap {
  std::vector<double> probability;  // P(f_i = 1 | xi): [places][features]
  std::vector<double> room;         // [places], see BeliefSpace

  Blob ToBlob() const;
  static FeatureMap FromBlob(const Blob& blob);
  void Append(const FeatureMap& block);
};

// `places`: all of them; the block is first <= k < end.
FeatureMap MapOfBlock(const Options& options, const Source& source, const std::vector<Place>& places,
                      std::size_t first, std::size_t end);

}  // namespace cairn::localization
