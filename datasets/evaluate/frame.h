// Whether the truth is in another unit than the map, or in a frame that is mirrored.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/matching/similarity.h"
#include "datasets/evaluate/scores.h"

namespace cairn::datasets {

// With the true positions divided by `scale`, and their x and y exchanged where `mirrored`, the map's are
// `rmse_m` off, after the rigid motion that is best.
struct OtherFrame {
  double scale = 1;
  bool mirrored = false;
  double rmse_m = 0;
  std::string Text() const;
};

// `pairs`: positions of the map and the true ones of the same. Nothing where no such frame makes them a fifth
// as far off as they are, or where there are too few of them to tell. A scale of nearly one is the map's
// error and no unit.
std::optional<OtherFrame> FindOtherFrame(const std::vector<PointPair>& pairs);

// `GROUP.frame_…`
void AddFrame(const std::string& group, const std::optional<OtherFrame>& frame, Scores* scores);

}  // namespace cairn::datasets
